// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/escaping.h"
#include "reports/tables/formats/table_formats.h"
#include "reports/tables/formats/table_head.h"
#include "reports/tables/text_table.h"

namespace stillpoint::report {
namespace {

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

}  // namespace stillpoint::report
