// SPDX-License-Identifier: BSD-3-Clause
/// Formats rows of cells as aligned text, Markdown or CSV.
#pragma once

#include <string>
#include <vector>

namespace stillpoint::report {

enum class TableStyle { kText, kMarkdown, kCsv };

/// The first row is the header. All rows have the same number of cells.
using TableRows = std::vector<std::vector<std::string>>;

[[nodiscard]] std::string format_table(const TableRows& rows, TableStyle style);

}  // namespace stillpoint::report
