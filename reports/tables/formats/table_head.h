// SPDX-License-Identifier: BSD-3-Clause
/// Table header layout shared by all formats.
#pragma once

#include <string>
#include <vector>

#include "reports/tables/report_table.h"

namespace stillpoint::report {

/// Consecutive columns under one heading.
struct ColumnGroup {
  std::string name;
  std::size_t columns = 0;
};

[[nodiscard]] std::vector<ColumnGroup> column_groups(const ReportTable& table);

/// Whether any column belongs to a named group.
[[nodiscard]] bool has_groups(const ReportTable& table);

/// Whether any row names its source.
[[nodiscard]] bool has_sources(const ReportTable& table);

/// "ATE [m]"; the name alone for a column without unit.
[[nodiscard]] std::string column_heading(const TableColumn& column);

/// Footnote 1 is "a"; after "z" comes "aa".
[[nodiscard]] std::string note_letter(std::size_t number);

}  // namespace stillpoint::report
