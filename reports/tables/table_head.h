// SPDX-License-Identifier: BSD-3-Clause
/// What all formats of a table need to know about its head.
#pragma once

#include <string>
#include <vector>

#include "reports/tables/report_table.h"

namespace stillpoint {

/// Neighbouring columns under one heading.
struct ColumnGroup {
  std::string name;
  std::size_t columns = 0;
};

[[nodiscard]] std::vector<ColumnGroup> column_groups(const ReportTable& table);

/// Whether some column has a heading above it.
[[nodiscard]] bool has_groups(const ReportTable& table);

/// Whether some row says where its numbers come from.
[[nodiscard]] bool has_sources(const ReportTable& table);

/// "ATE [m]"; the name alone for a column without unit.
[[nodiscard]] std::string column_heading(const TableColumn& column);

/// Footnote 1 is "a"; after "z" comes "aa".
[[nodiscard]] std::string note_letter(std::size_t number);

}  // namespace stillpoint
