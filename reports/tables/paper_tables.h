// SPDX-License-Identifier: BSD-3-Clause
/// The paper's Tables I, II and III with its rows, columns and units: published, ours and difference. Paper
/// Sec. IV.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "bench/model/stored_run.h"
#include "reports/tables/report_table.h"

namespace stillpoint::report {

enum class PaperTable { kTable1, kTable2, kTable3 };

/// The table that a plan reproduces, by prefix of its name: "table1_" etc.; nullopt for other plans.
[[nodiscard]] std::optional<PaperTable> paper_table_of(std::string_view plan);

/// @param runs of that table's plan; the rows "ours" are empty without runs
[[nodiscard]] ReportTable paper_table(PaperTable table, std::span<const bench::StoredRun> runs);

}  // namespace stillpoint::report
