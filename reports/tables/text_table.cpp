// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/text_table.h"

#include <algorithm>

namespace stillpoint::report {
namespace {

std::string csv_cell(const std::string& cell) {
  if (cell.find_first_of(",\"\n") == std::string::npos) return cell;
  std::string quoted(1, '"');
  for (const char c : cell) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  quoted += '"';
  return quoted;
}

std::vector<std::size_t> widths_of(const TableRows& rows) {
  std::vector<std::size_t> widths(rows.front().size(), 3);  // the Markdown delimiter row needs three dashes
  for (const std::vector<std::string>& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  return widths;
}

}  // namespace

std::string format_table(const TableRows& rows, TableStyle style) {
  std::string text;
  if (rows.empty()) return text;
  const std::vector<std::size_t> widths = widths_of(rows);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (style == TableStyle::kMarkdown) text += "| ";
    for (std::size_t i = 0; i < rows[r].size(); ++i) {
      const std::string& cell = rows[r][i];
      if (i > 0) text += style == TableStyle::kCsv ? "," : style == TableStyle::kMarkdown ? " | " : "  ";
      text += style == TableStyle::kCsv ? csv_cell(cell) : cell;
      if (style != TableStyle::kCsv) text.append(widths[i] - cell.size(), ' ');
    }
    while (!text.empty() && text.back() == ' ') text.pop_back();
    text += style == TableStyle::kMarkdown ? " |\n" : "\n";
    if (r > 0 || style != TableStyle::kMarkdown) continue;
    for (const std::size_t width : widths) {
      text += '|';
      text.append(width + 2, '-');
    }
    text += "|\n";
  }
  return text;
}

}  // namespace stillpoint::report
