// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/table_formats.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

/// Consecutive columns under one heading.
struct ColumnGroup {
  std::string name;
  std::size_t columns = 0;
};

std::vector<ColumnGroup> column_groups(const ReportTable& table) {
  std::vector<ColumnGroup> groups;
  for (const TableColumn& column : table.columns) {
    if (groups.empty() || groups.back().name != column.group)
      groups.push_back({.name = column.group, .columns = 0});
    ++groups.back().columns;
  }
  return groups;
}

/// Whether any column belongs to a named group.
bool has_groups(const ReportTable& table) {
  return std::any_of(table.columns.begin(), table.columns.end(),
                     [](const TableColumn& column) { return !column.group.empty(); });
}

/// Whether any row names its source.
bool has_sources(const ReportTable& table) {
  return std::any_of(table.rows.begin(), table.rows.end(),
                     [](const TableRow& row) { return !row.source.empty(); });
}

/// "ATE [m]"; the name alone for a column without unit.
std::string column_heading(const TableColumn& column) {
  return column.unit.empty() ? column.name : column.name + " [" + column.unit + "]";
}

/// Footnote 1 is "a"; after "z" comes "aa".
std::string note_letter(std::size_t number) {
  constexpr std::size_t kLetters = 26;
  std::string letters;
  for (; number > 0; number = (number - 1) / kLetters) {
    letters.insert(letters.begin(), static_cast<char>('a' + static_cast<char>((number - 1) % kLetters)));
  }
  return letters;
}

std::string markdown_cell(const TableColumn& column, const TableCell& cell, TableDetail detail,
                          const std::vector<std::string>& notes) {
  std::string text = cell_text(column, cell, detail);
  if (cell.is_best) text = "**" + text + "**";
  const std::size_t note = footnote_number(notes, cell);
  return note == 0 ? text : text + " (" + note_letter(note) + ")";
}

}  // namespace

std::string table_markdown(const ReportTable& table, TableDetail detail) {
  const std::vector<std::string> notes = footnotes(table);
  TableRows rows(1);
  rows.front().push_back(escape_markdown(table.row_heading));
  if (has_sources(table)) rows.front().emplace_back("source");
  for (const TableColumn& column : table.columns) {
    const std::string group = column.group.empty() ? "" : column.group + ": ";
    rows.front().push_back(escape_markdown(group + column_heading(column)));
  }
  for (const TableRow& row : table.rows) {
    std::vector<std::string>& cells = rows.emplace_back();
    cells.push_back(escape_markdown(row.label));
    if (has_sources(table)) cells.push_back(escape_markdown(row.source));
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      cells.push_back(markdown_cell(table.columns[i], row.cells[i], detail, notes));
    }
  }
  std::string text =
      "## " + escape_markdown(table.title) + "\n\n" + format_table(rows, TableStyle::kMarkdown) + "\n";
  for (std::size_t i = 0; i < notes.size(); ++i) {
    text += "- (" + note_letter(i + 1) + ") " + escape_markdown(notes[i]) + "\n";
  }
  for (const std::string& note : table.notes) text += "- " + escape_markdown(note) + "\n";
  return text;
}

namespace {

std::string latex_cell(const TableColumn& column, const TableCell& cell, TableDetail detail,
                       const std::vector<std::string>& notes) {
  std::string text = cell_text(column, cell, detail);
  if (text == "-") text = "--";
  if (cell.is_best) text = "\\textbf{" + text + "}";
  const std::size_t note = footnote_number(notes, cell);
  return note == 0 ? text : text + "$^{\\mathrm{" + note_letter(note) + "}}$";
}

/// The line of group headings and the rules below it.
std::string group_line(const ReportTable& table, std::size_t lead) {
  std::string line(lead - 1, '&');
  std::string rules;
  std::size_t column = lead + 1;
  for (const ColumnGroup& group : column_groups(table)) {
    line += fmt::format(" & \\multicolumn{{{}}}{{c}}{{{}}}", group.columns, escape_latex(group.name));
    if (!group.name.empty())
      rules += fmt::format("\\cmidrule(lr){{{}-{}}}", column, column + group.columns - 1);
    column += group.columns;
  }
  return line + " \\\\\n" + rules + "\n";
}

std::string heading_line(const ReportTable& table) {
  std::string line = escape_latex(table.row_heading);
  if (has_sources(table)) line += " & source";
  for (const TableColumn& column : table.columns) line += " & " + escape_latex(column_heading(column));
  return line + " \\\\\n\\midrule\n";
}

std::string note_lines(const ReportTable& table, const std::vector<std::string>& notes) {
  std::string text;
  for (std::size_t i = 0; i < notes.size(); ++i) {
    text += fmt::format("$^{{\\mathrm{{{}}}}}$ {}\\\\\n", note_letter(i + 1), escape_latex(notes[i]));
  }
  for (const std::string& note : table.notes) text += escape_latex(note) + "\\\\\n";
  return text.empty()
             ? ""
             : "\n\\vspace{1ex}\n\\begin{minipage}{\\linewidth}\\footnotesize\n" + text + "\\end{minipage}\n";
}

}  // namespace

std::string table_latex(const ReportTable& table, TableDetail detail) {
  const std::vector<std::string> notes = footnotes(table);
  const std::size_t lead = has_sources(table) ? 2 : 1;
  std::string text = "\\begin{table*}[t]\n\\centering\n\\caption{" + escape_latex(table.title) + "}\n";
  text += "\\label{table:" + table.name + "}\n";
  text += fmt::format("\\begin{{tabular}}{{{}{}}}\n\\toprule\n", std::string(lead, 'l'),
                      std::string(table.columns.size(), 'r'));
  if (has_groups(table)) text += group_line(table, lead);
  text += heading_line(table);
  std::string label = table.rows.empty() ? "" : table.rows.front().label;
  for (const TableRow& row : table.rows) {
    if (lead == 2 && row.label != label) text += "\\addlinespace\n";
    label = row.label;
    text += escape_latex(row.label);
    if (lead == 2) text += " & " + escape_latex(row.source);
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      text += " & " + latex_cell(table.columns[i], row.cells[i], detail, notes);
    }
    text += " \\\\\n";
  }
  return text + "\\bottomrule\n\\end{tabular}\n" + note_lines(table, notes) + "\\end{table*}\n";
}

std::string latex_document(const std::string& tables) {
  return "\\documentclass{article}\n\\usepackage[utf8]{inputenc}\n\\usepackage{booktabs}\n"
         "\\usepackage[a3paper,landscape,margin=1cm]{geometry}\n\\begin{document}\n\\scriptsize\n" +
         tables + "\\end{document}\n";
}

namespace {

std::string attribute(const char* name, const std::string& value) {
  return value.empty() ? "" : fmt::format(" {}=\"{}\"", name, escape_html(value));
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// Tooltip of a number.
std::string tooltip(const TableColumn& column, const TableCell& cell) {
  std::string text = cell.count > 0 ? cell_text(column, cell, TableDetail::kSpread) : "";
  for (const std::string& part : {cell.protocol, cell.note}) {
    if (!part.empty()) text += (text.empty() ? "" : "; ") + part;
  }
  return text;
}

struct HtmlTable {
  const ReportTable& table;
  std::vector<std::string> notes;

  [[nodiscard]] std::string cell(const TableColumn& column, const TableCell& cell) const {
    std::string text = number_text(column, cell);
    if (cell.is_best) text = "<strong>" + text + "</strong>";
    if (!cell.run_keys.empty()) {
      text = fmt::format("<a href=\"#run={}\"{}>{}</a>", escape_html(cell.run_keys.front()),
                         attribute("data-runs", joined(cell.run_keys)), text);
    }
    if (const std::size_t note = footnote_number(notes, cell); note != 0) {
      text += fmt::format("<sup><a href=\"#{}-note-{}\">{}</a></sup>", escape_html(table.name), note,
                          note_letter(note));
    }
    if (cell.number && cell.count > 0)
      text += "<span class=\"spread\">" + spread_text(cell, column.decimals) + "</span>";
    const std::string classes = cell_state_name(cell.state) + (cell.is_suspicious ? " suspicious" : "");
    return "<td" + attribute("class", classes) + attribute("title", tooltip(column, cell)) + ">" + text +
           "</td>";
  }

  [[nodiscard]] std::string head() const {
    const char* span = has_groups(table) ? " rowspan=\"2\"" : "";
    std::string text =
        fmt::format("<thead><tr><th scope=\"col\"{}>{}</th>", span, escape_html(table.row_heading));
    if (has_sources(table)) text += fmt::format("<th scope=\"col\"{}>source</th>", span);
    if (has_groups(table)) {
      for (const ColumnGroup& group : column_groups(table)) {
        text += fmt::format("<th scope=\"colgroup\" colspan=\"{}\">{}</th>", group.columns,
                            escape_html(group.name));
      }
      text += "</tr><tr>";
    }
    for (const TableColumn& column : table.columns) {
      text += "<th scope=\"col\"" + attribute("title", column.tooltip) + ">" +
              escape_html(column_heading(column)) + "</th>";
    }
    return text + "</tr></thead>\n";
  }

  [[nodiscard]] std::string row(const TableRow& row) const {
    std::string text =
        "<tr" + attribute("class", row.source) + "><th scope=\"row\">" + escape_html(row.label) + "</th>";
    if (has_sources(table)) text += "<td class=\"text\">" + escape_html(row.source) + "</td>";
    for (std::size_t i = 0; i < row.cells.size(); ++i) text += cell(table.columns[i], row.cells[i]);
    return text + "</tr>\n";
  }

  [[nodiscard]] std::string foot() const {
    std::string text;
    for (std::size_t i = 0; i < notes.size(); ++i) {
      text += fmt::format("<li id=\"{}-note-{}\"><sup>{}</sup> {}</li>", escape_html(table.name), i + 1,
                          note_letter(i + 1), escape_html(notes[i]));
    }
    for (const std::string& note : table.notes) text += "<li>" + escape_html(note) + "</li>";
    return text.empty() ? "" : "<ul class=\"notes\">" + text + "</ul>\n";
  }
};

}  // namespace

std::string table_html(const ReportTable& table) {
  const HtmlTable html{table, footnotes(table)};
  const std::string caption =
      table.description.empty() ? table.title : table.title + ". " + table.description;
  std::string text = fmt::format("<div class=\"table\"><table id=\"table-{}\"><caption>{}</caption>\n",
                                 escape_html(table.name), escape_html(caption));
  text += html.head() + "<tbody>\n";
  for (const TableRow& row : table.rows) text += html.row(row);
  return text + "</tbody></table></div>\n" + html.foot();
}

namespace {

using Json = nlohmann::ordered_json;

Json cell_json(const TableColumn& column, const TableCell& cell) {
  Json json;
  json["state"] = cell_state_name(cell.state);
  // The number as printed, so that the file and the page agree.
  json["value"] = cell.number ? Json::parse(number_text(column, cell)) : Json(nullptr);
  json["exact"] = cell.number ? Json(*cell.number) : Json(nullptr);
  json["n"] = cell.count;
  if (cell.worst) json["worst"] = *cell.worst;
  if (cell.modes) json["modes"] = *cell.modes;
  json["interval"] = cell.interval ? Json({cell.interval->low, cell.interval->high}) : Json(nullptr);
  json["best"] = cell.is_best;
  if (cell.is_suspicious) json["suspicious"] = true;
  if (!cell.note.empty()) json["note"] = clean_line(cell.note);
  if (!cell.protocol.empty()) json["protocol"] = clean_line(cell.protocol);
  json["runs"] = cell.run_keys;
  return json;
}

}  // namespace

std::string table_csv(const ReportTable& table) {
  std::string text = "row,source,group,column,unit,value,n,low,high,state,note\n";
  for (const TableRow& row : table.rows) {
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const TableColumn& column = table.columns[i];
      const TableCell& cell = row.cells[i];
      const std::string number = cell.number ? number_text(column, cell) : "";
      const auto limit = [&](double value) { return fmt::format("{:.{}f}", value, column.decimals); };
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(row.label), csv_field(row.source),
                          csv_field(column.group), csv_field(column.name), csv_field(column.unit), number,
                          cell.count, cell.interval ? limit(cell.interval->low) : "",
                          cell.interval ? limit(cell.interval->high) : "", cell_state_name(cell.state),
                          csv_field(cell.note));
    }
  }
  return text;
}

Json table_json(const ReportTable& table) {
  Json json;
  json["name"] = table.name;
  json["title"] = clean_line(table.title);
  json["row_heading"] = clean_line(table.row_heading);
  json["columns"] = Json::array();
  for (const TableColumn& column : table.columns) {
    json["columns"].push_back({{"group", clean_line(column.group)},
                               {"name", clean_line(column.name)},
                               {"unit", clean_line(column.unit)}});
  }
  json["rows"] = Json::array();
  for (const TableRow& row : table.rows) {
    Json cells = Json::array();
    for (std::size_t i = 0; i < row.cells.size(); ++i)
      cells.push_back(cell_json(table.columns[i], row.cells[i]));
    json["rows"].push_back(
        {{"label", clean_line(row.label)}, {"source", clean_line(row.source)}, {"cells", cells}});
  }
  json["notes"] = Json::array();
  for (const std::string& note : table.notes) json["notes"].push_back(clean_line(note));
  return json;
}

}  // namespace stillpoint::report
