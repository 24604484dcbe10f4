// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/table_formats.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.h"

namespace stillpoint::report {
namespace {

/// Names that break unescaped pages and tables.
const std::vector<std::string> kHostile = {"<script>alert('x')</script>",
                                           "\"quoted\" & 'more'",
                                           "\\input{/etc/passwd} $x_1^2$ 50% #1 ~",
                                           "pipe | and\nnew line\tand tab",
                                           "=cmd(),\"x\"",
                                           "\xF0\x9F\x98\x80 \xE4\xB8\xAD \xD7\x90 \xC3\xA9",
                                           "broken \xFF\xC0",
                                           "--> ]]> <!-- <!--data-->",
                                           "[a](javascript:x) `code`",
                                           std::string(3000, 'w')};

ReportTable hostile_table() {
  ReportTable table{.name = "hostile", .title = kHostile[0], .row_heading = kHostile[1]};
  for (const std::string& name : kHostile)
    table.columns.push_back({.group = name, .name = name, .unit = name, .decimals = 3});
  for (const std::string& name : kHostile) {
    TableRow row{.label = name, .source = name, .cells = {}};
    for (const std::string& note : kHostile) {
      row.cells.push_back(
          {.number = 1.0, .state = CellState::kOk, .note = note, .run_keys = {"0a"}, .protocol = name});
    }
    table.rows.push_back(std::move(row));
  }
  table.notes = kHostile;
  return table;
}

ReportTable small_table() {
  return {.name = "small",
          .title = "Small",
          .row_heading = "sequence",
          .columns = {{"A", "ATE", "m", 4}, {"B", "ATE", "m", 4}},
          .rows = {{"xyz",
                    "ours",
                    {{.number = 0.04864,
                      .state = CellState::kPartial,
                      .is_best = true,
                      .note = "1 of 3 runs failed",
                      .count = 8,
                      .interval = eval::Interval{0.04, 0.05}},
                     {.state = CellState::kFailed}}}},
          .notes = {"A note."}};
}

TEST(TableFormats, MarkdownMarksBestValuesAndFootnotes) {
  EXPECT_EQ(table_markdown(small_table()),
            "## Small\n\n"
            "| sequence | source | A: ATE \\[m\\]   | B: ATE \\[m\\] |\n"
            "|----------|--------|----------------|--------------|\n"
            "| xyz      | ours   | **0.0486** (a) | failed |\n\n"
            "- (a) 1 of 3 runs failed\n- A note.\n");
}

TEST(TableFormats, SpreadIsShownOnRequest) {
  EXPECT_NE(table_markdown(small_table(), TableDetail::kSpread).find("0.0486 (n = 8, 0.0400 to 0.0500)"),
            std::string::npos);
  EXPECT_EQ(table_markdown(small_table()).find("(n ="), std::string::npos);
}

TEST(TableFormats, SeveralModesAreShownWithTheSpread) {
  ReportTable table = small_table();
  TableCell& cell = table.rows.front().cells.front();
  cell.worst = 0.07;
  cell.modes = 2;
  EXPECT_NE(table_html(table).find("worst 0.0700, 2 modes</span>"), std::string::npos);
  EXPECT_EQ(table_json(table)["rows"][0]["cells"][0]["modes"], 2);
  cell.modes = 1;
  EXPECT_EQ(table_html(table).find("mode"), std::string::npos);
}

TEST(TableFormats, AMissingIntervalIsStatedWithTheNumberOfRuns) {
  ReportTable table = small_table();
  TableCell& cell = table.rows.front().cells.front();
  cell.count = 3;
  cell.interval.reset();
  EXPECT_NE(table_markdown(table, TableDetail::kSpread).find("0.0486 (n = 3, no interval)"),
            std::string::npos);
  EXPECT_NE(table_html(table).find("<span class=\"spread\">n = 3, no interval</span>"), std::string::npos);
  EXPECT_NE(table_csv(table).find(",0.0486,3,,,partial,"), std::string::npos);
  const nlohmann::ordered_json json = table_json(table)["rows"][0]["cells"][0];
  EXPECT_TRUE(json["interval"].is_null());
  EXPECT_EQ(json["n"], 3);
}

TEST(TableFormats, LatexHasBooktabsAndGroups) {
  const std::string text = table_latex(small_table());
  for (const char* part :
       {"\\toprule", "\\midrule", "\\bottomrule", "\\multicolumn{1}{c}{A}", "\\cmidrule(lr){3-3}",
        "\\textbf{0.0486}$^{\\mathrm{a}}$", "failed", "\\label{table:small}"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
}

TEST(TableFormats, CsvHasOneLinePerCell) {
  EXPECT_EQ(table_csv(small_table()),
            "row,source,group,column,unit,value,n,low,high,state,note\n"
            "xyz,ours,A,ATE,m,0.0486,8,0.0400,0.0500,partial,1 of 3 runs failed\n"
            "xyz,ours,B,ATE,m,,0,,,failed,\n");
}

/// Numbers of a Markdown table, row by row, without markup.
std::vector<std::string> markdown_numbers(const std::string& text) {
  std::vector<std::string> numbers;
  std::string word;
  for (const char letter : text) {
    if (std::isdigit(static_cast<unsigned char>(letter)) != 0 || letter == '.' || letter == '-') {
      word += letter;
      continue;
    }
    if (word.find('.') != std::string::npos) numbers.push_back(word);
    word.clear();
  }
  return numbers;
}

TEST(TableFormats, NumbersAreEqualInAllFormats) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-4.0, 5.0);
  for (int trial = 0; trial < 50; ++trial) {
    ReportTable table{.name = "t", .title = "t", .row_heading = "r"};
    for (int decimals = 1; decimals <= 5; ++decimals) table.columns.push_back({"", "c", "", decimals});
    TableRow row{.label = "r", .source = "", .cells = {}};
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      const double sign = trial % 2 == 0 ? 1.0 : -1.0;
      row.cells.push_back({.number = sign * std::pow(10.0, exponent(random)), .state = CellState::kOk});
    }
    table.rows.push_back(row);
    const std::vector<std::string> markdown = markdown_numbers(table_markdown(table));
    const nlohmann::ordered_json json = table_json(table);
    ASSERT_EQ(markdown.size(), row.cells.size());
    std::istringstream csv(table_csv(table));
    std::string line;
    std::getline(csv, line);
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      std::getline(csv, line);
      EXPECT_NE(line.find("," + markdown[i] + ","), std::string::npos) << line;
      EXPECT_EQ(json["rows"][0]["cells"][i]["value"].get<double>(), std::stod(markdown[i]));
    }
  }
}

TEST(TableFormats, HostileNamesAreEscapedInHtml) {
  const std::string text = table_html(hostile_table());
  EXPECT_EQ(text.find("<script"), std::string::npos);
  EXPECT_EQ(text.find("<!--"), std::string::npos);
  EXPECT_EQ(text.find("'x'"), std::string::npos);
}

TEST(TableFormats, HostileNamesDoNotBreakRowsOrColumns) {
  const ReportTable table = hostile_table();
  const std::string markdown = table_markdown(table);
  // Only the header and the table rows start with "| "; no row is split.
  std::istringstream lines(markdown);
  std::string line;
  std::size_t rows = 0;
  while (std::getline(lines, line)) rows += line.starts_with("| ") ? 1 : 0;
  EXPECT_EQ(rows, table.rows.size() + 1);
  const std::string csv = table_csv(table);
  const auto ends = static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n'));
  EXPECT_EQ(ends, table.rows.size() * table.columns.size() + 1);
  EXPECT_NO_THROW(static_cast<void>(table_json(table).dump()));
}

/// Whether unescaped braces are balanced.
bool has_balanced_braces(const std::string& text) {
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\') {
      ++i;
      continue;
    }
    depth += text[i] == '{' ? 1 : text[i] == '}' ? -1 : 0;
    if (depth < 0) return false;
  }
  return depth == 0;
}

TEST(TableFormats, LatexCompiles) {
  const std::string document =
      latex_document(table_latex(small_table(), TableDetail::kSpread) + table_latex(hostile_table()));
  EXPECT_TRUE(has_balanced_braces(document));
  if (std::system("command -v pdflatex >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "no pdflatex; apt-get install texlive-latex-recommended to compile the tables";
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "tables.tex") << document;
  const std::string command =
      fmt::format("cd {} && pdflatex -halt-on-error -interaction=nonstopmode tables.tex > out.txt 2>&1",
                  folder.path().string());
  EXPECT_EQ(std::system(command.c_str()), 0) << std::ifstream(folder.path() / "out.txt").rdbuf();
}

}  // namespace
}  // namespace stillpoint::report
