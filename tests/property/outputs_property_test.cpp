// SPDX-License-Identifier: BSD-3-Clause
// Every output over 50 random stores with planted effects, through files: base, number of values, sign, and
// certainty in `stats`, comparisons, report page, tables and dashboard.
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/analysis/comparison.h"
#include "reports/dashboard/dashboard.h"
#include "reports/page/report_page.h"
#include "reports/text/comparison_report.h"
#include "tests/property/stats_rows.h"
#include "tests/property/stored_case.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::json;

constexpr unsigned kStores = 50;

struct StoredCase {
  explicit StoredCase(unsigned seed)
      : planted(StorePlanter(seed, {.replicates = 9, .sequences = 2, .builds = 3}).planted()),
        newest(runs_with(planted, planted.builds.back())) {
    write_store(planted, file);
  }

  TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "store.sqlite";
  PlantedStore planted;
  std::vector<StoredRun> newest;
};

void expect_summary(const StoredCase& stored) {
  for (const auto& row : stats_rows("summary", stored.file)) {
    const std::size_t count = succeeded(stored.newest, row.at("variant"), row.at("sequence"));
    EXPECT_EQ(row.at("build"), stored.planted.builds.back());
    EXPECT_EQ(row.at("n"), std::to_string(count));
    if (count == 0) continue;
    EXPECT_EQ(!row.at("median_low").empty(), count >= kSmallestCount) << row.at("median_low");
    EXPECT_EQ(!row.at("median_high").empty(), count >= kSmallestCount) << row.at("median_high");
  }
}

/// The row "(all)" of the ablation: number of pairs, sign, and certainty.
/// @return whether the interval excludes 0
bool expect_ablation(const StoredCase& stored) {
  const std::size_t count = paired_values(stored.newest, stored.planted.base);
  for (const auto& row : stats_rows("ablation", stored.file)) {
    EXPECT_EQ(row.at("build"), stored.planted.builds.back());
    EXPECT_EQ(row.at("base"), stored.planted.base);
    EXPECT_EQ(row.at("variant"), kChangedVariant);
    if (row.at("sequence") != "(all)") continue;
    EXPECT_EQ(row.at("n"), std::to_string(count));
    const std::string& interval = row.at("difference_low");
    EXPECT_EQ(!interval.empty(), count >= kSmallestCount) << interval;
    if (interval.empty()) return false;
    const double low = std::stod(interval);
    const double high = std::stod(row.at("difference_high"));
    if (low <= 0.0 && high >= 0.0) return false;
    if (stored.planted.variant_effect != 1.0) {
      EXPECT_EQ(sign_of(low), sign_of(stored.planted.variant_effect - 1.0)) << interval;
    }
    EXPECT_EQ(sign_of(std::stod(row.at("difference"))), sign_of(low));
    return true;
  }
  return false;
}

/// Text of the cell "all" of the changed variant in the first heat map; empty if there is none.
std::string heat_cell(const std::string& page) {
  const std::size_t map = page.find("class=\"heat\"");
  const std::size_t row = page.find(std::string("<th scope=\"row\">") + kChangedVariant + "</th>", map);
  if (map == std::string::npos || row == std::string::npos) return "";
  const std::size_t cell = page.find("<td", row);
  return page.substr(cell, page.find("</td>", cell) - cell);
}

void expect_page(const StoredCase& stored, const std::string& page, bool is_certain) {
  const std::size_t count = paired_values(stored.newest, stored.planted.base);
  const std::string cell = heat_cell(page);
  if (count == 0) return;
  EXPECT_NE(page.find("relative to " + stored.planted.base + ", base of plan p"), std::string::npos);
  EXPECT_NE(cell.find(fmt::format("n = {},", count)), std::string::npos) << cell;
  EXPECT_EQ(cell.find("insignificant") == std::string::npos, is_certain) << cell;
  EXPECT_EQ(cell.find("no interval") == std::string::npos, count >= kSmallestCount) << cell;
  if (is_certain && stored.planted.variant_effect != 1.0) {
    EXPECT_NE(cell.find(stored.planted.variant_effect > 1.0 ? "\"worse" : "\"better"), std::string::npos)
        << cell;
  }
}

/// Numbers of the tables have the right count, are of the newest build only, and have intervals only from six
/// values on; LaTeX says what bold means.
void expect_tables(const StoredCase& stored, const report::ReportSubject& subject) {
  std::map<std::string, const StoredRun*> runs;
  for (const StoredRun& run : stored.newest) runs[run.key] = &run;
  for (const report::ReportTable& table : report::report_tables(subject)) {
    const std::vector<OutputFile> files = report::table_files(table);
    const Json json = Json::parse(files.back().text);
    for (const Json& row : json.at("rows")) {
      for (const Json& cell : row.at("cells")) {
        std::size_t count = 0;
        for (const std::string key : cell.at("runs")) {
          ASSERT_TRUE(runs.contains(key)) << table.name;
          count += runs.at(key)->outcome == Outcome::kOk ? 1 : 0;
        }
        if (cell.at("value").is_null() || cell.at("runs").empty()) continue;
        EXPECT_EQ(cell.at("n").get<std::size_t>(), count) << table.name;
        EXPECT_EQ(cell.at("interval").is_null(), count < kSmallestCount) << table.name;
      }
    }
    for (const OutputFile& file : files) {
      const bool has_bold =
          (file.name.ends_with(".tex") && file.text.find("\\textbf") != std::string::npos) ||
          (file.name.ends_with(".md") && file.text.find("**") != std::string::npos);
      if (!has_bold) continue;
      EXPECT_NE(file.text.find("not a statement of significance"), std::string::npos) << file.text;
      EXPECT_NE(file.text.find("n = "), std::string::npos) << file.text;
    }
  }
}

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// Comparison of the last two builds: Markdown, JSON, JUnit and the page agree with the planted effect.
/// @return whether a class is wrong
bool expect_comparison(const StoredCase& stored, const std::string& page) {
  const Store store(stored.file);
  const auto& builds = stored.planted.builds;
  const std::vector<StoredRun> base = store.runs({.build = builds[builds.size() - 2]});
  const Comparison comparison = compare_runs(base, store.runs({.build = builds.back()}));
  const report::ComparisonTitle title{.base = "base", .head = "head"};
  const Json json = Json::parse(report::comparison_json(title, comparison));
  const std::string junit = report::comparison_junit(title, comparison);
  const std::string markdown = report::comparison_markdown(title, comparison);
  EXPECT_EQ(json.at("pairs").get<std::size_t>(), stored.newest.size());
  EXPECT_NE(markdown.find(fmt::format("{} pair", stored.newest.size())), std::string::npos);
  EXPECT_TRUE(json.at("missing").empty());
  std::size_t failures = comparison.failures == ChangeClass::kWorse ? 1 : 0;
  bool is_any_wrong = false;
  for (const Json& change : json.at("changes")) {
    const std::string result = change.at("result");
    failures += result == "worse" ? 1 : 0;
    if (change.at("test") == "signed_rank") {
      EXPECT_EQ(change.at("interval").is_null(), change.at("n").get<std::size_t>() < kSmallestCount)
          << change;
    }
    if (result != "worse" && result != "better") continue;
    EXPECT_EQ(sign_of(change.at("change").get<double>()), result == "worse" ? 1 : -1) << change;
    const int planted = change.at("metric") == "ate_rmse_m" ? sign_of(stored.planted.build_effect - 1.0) : 0;
    is_any_wrong = is_any_wrong || planted != (result == "worse" ? 1 : -1);
  }
  EXPECT_EQ(occurrences(junit, "<failure"), failures) << junit;
  EXPECT_EQ(occurrences(junit, "<error"), comparison.has_result() ? 0U : 1U) << junit;
  EXPECT_NE(markdown.find(": " + json.at("result").get<std::string>() + "\n"), std::string::npos) << markdown;
  const std::string sentence = fmt::format("Compared with build {}: {}; {} pair", builds[builds.size() - 2],
                                           json.at("result").get<std::string>(), stored.newest.size());
  EXPECT_NE(page.find(sentence), std::string::npos) << sentence;
  return is_any_wrong;
}

/// With at most three commits only failed runs can be regressions.
void expect_dashboard(const std::filesystem::path& file) {
  for (const OutputFile& output : report::dashboard_files(Store(file))) {
    if (output.name != "regressions.json") continue;
    for (const Json& open : Json::parse(output.text).at("open")) EXPECT_EQ(open.at("metric"), "failed_runs");
  }
}

bool has_succeeded(const std::vector<StoredRun>& runs) {
  return std::any_of(runs.begin(), runs.end(),
                     [](const StoredRun& run) { return run.outcome == Outcome::kOk; });
}

TEST(Outputs, StateWhatWasPlanted) {
  FalseAlarms differences;
  FalseAlarms classes;
  int certain = 0;
  for (unsigned seed = 1; seed <= kStores; ++seed) {
    SCOPED_TRACE(seed);
    const StoredCase stored(seed);
    if (!has_succeeded(stored.newest)) continue;
    expect_summary(stored);
    const bool is_certain = expect_ablation(stored);
    if (stored.planted.variant_effect == 1.0) differences.add(is_certain);
    certain += is_certain ? 1 : 0;
    const Store store(stored.file);
    const report::ReportSubject subject = report::report_subject(store, "");
    const std::string page = report::report_html(store, subject);
    expect_page(stored, page, is_certain);
    expect_tables(stored, subject);
    if (stored.planted.builds.size() > 1) classes.add(expect_comparison(stored, page));
    expect_dashboard(stored.file);
  }
  EXPECT_LE(differences.made, differences.limit(0.05));
  EXPECT_LE(classes.made, classes.limit(0.05));
  EXPECT_GT(certain, 2);  // (all) needs six sequences, or one with six pairs
}

TEST(Outputs, AreMadeWithAMarkedGapIfAFileIsMissing) {
  for (unsigned seed = 101; seed <= 105; ++seed) {
    SCOPED_TRACE(seed);
    const StoredCase stored(seed);
    if (!has_succeeded(stored.newest) || !remove_blob(stored.planted, stored.file)) continue;
    const bool is_certain = expect_ablation(stored);
    const Store store(stored.file);
    const report::ReportSubject subject = report::report_subject(store, "");
    EXPECT_EQ(subject.gaps.size(), 1U);
    const std::string page = report::report_html(store, subject);
    EXPECT_NE(page.find("class=\"gap\""), std::string::npos);
    expect_page(stored, page, is_certain);
    expect_tables(stored, subject);
    expect_dashboard(stored.file);
  }
}

/// 45 commits with one run each, and a step of the error after 25 of them.
std::filesystem::path write_history(const std::filesystem::path& file, double step, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 0.02);
  StoreWriter writer(file);
  for (int i = 0; i < 45; ++i) {
    const RunIdentity identity{.variant = "vo", .sequence = "a", .build = fmt::format("build{:02}", i)};
    static_cast<void>(writer.acquire(identity));
    const double error = 0.01 * (i < 25 ? 1.0 : step) * (1.0 + noise(random));
    writer.finish(identity,
                  {.metrics = {{"ate_rmse_m", "", "m", error}},
                   .manifest = fmt::format(R"({{"build": {{"git_commit": "{}", "git_time": "{}"}}}})",
                                           identity.build, fmt::format("2026-01-01T00:00:{:02}Z", i))});
  }
  return file;
}

TEST(Outputs, TheDashboardListsAPlantedStepAsARegressionOnlyIfItIsWorse) {
  for (unsigned seed = 1; seed <= 9; ++seed) {
    SCOPED_TRACE(seed);
    const double step = std::array{1.0, 1.4, 1.0 / 1.4}[seed % 3];
    const TemporaryFolder folder;
    const std::filesystem::path file = write_history(folder.path() / "store.sqlite", step, seed);
    for (const OutputFile& output : report::dashboard_files(Store(file))) {
      if (output.name != "regressions.json") continue;
      const Json open = Json::parse(output.text).at("open");
      ASSERT_EQ(open.size(), step > 1.0 ? 1U : 0U) << output.text;
      if (open.empty()) continue;
      EXPECT_EQ(open.front().at("metric"), "ate_rmse_m");
      EXPECT_EQ(open.front().at("first_commit_after"), "build25");
      EXPECT_GT(open.front().at("interval").front().get<double>(), 0.0);
      EXPECT_EQ(open.front().at("n"), 20);  // of the smaller side
    }
  }
}

}  // namespace
}  // namespace stillpoint::bench
