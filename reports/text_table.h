// SPDX-License-Identifier: BSD-3-Clause
/// Rows of cells as aligned text, Markdown or CSV.
#pragma once

#include <string>
#include <vector>

namespace stillpoint {

enum class TableStyle { kText, kMarkdown, kCsv };

/// The first row is the header. Every row has as many cells.
using TableRows = std::vector<std::vector<std::string>>;

[[nodiscard]] std::string format_table(const TableRows& rows, TableStyle style);

}  // namespace stillpoint
