// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "reports/tables/escaping.h"
#include "reports/tables/formats/table_formats.h"
#include "reports/tables/formats/table_head.h"

namespace stillpoint::report {
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

}  // namespace stillpoint::report
