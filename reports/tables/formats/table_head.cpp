// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/formats/table_head.h"

#include <algorithm>

namespace stillpoint::report {

std::vector<ColumnGroup> column_groups(const ReportTable& table) {
  std::vector<ColumnGroup> groups;
  for (const TableColumn& column : table.columns) {
    if (groups.empty() || groups.back().name != column.group)
      groups.push_back({.name = column.group, .columns = 0});
    ++groups.back().columns;
  }
  return groups;
}

bool has_groups(const ReportTable& table) {
  return std::any_of(table.columns.begin(), table.columns.end(),
                     [](const TableColumn& column) { return !column.group.empty(); });
}

bool has_sources(const ReportTable& table) {
  return std::any_of(table.rows.begin(), table.rows.end(),
                     [](const TableRow& row) { return !row.source.empty(); });
}

std::string column_heading(const TableColumn& column) {
  return column.unit.empty() ? column.name : column.name + " [" + column.unit + "]";
}

std::string note_letter(std::size_t number) {
  constexpr std::size_t kLetters = 26;
  std::string letters;
  for (; number > 0; number = (number - 1) / kLetters) {
    letters.insert(letters.begin(), static_cast<char>('a' + static_cast<char>((number - 1) % kLetters)));
  }
  return letters;
}

}  // namespace stillpoint::report
