// SPDX-License-Identifier: BSD-3-Clause
/// The paper's Tables I, II and III with its rows, columns and units; ours, published and difference beside
/// each other. Paper Sec. IV.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "bench/store/stored_run.h"
#include "reports/tables/report_table.h"

namespace stillpoint {

enum class PaperTable { kTable1, kTable2, kTable3 };

/// The table that a plan makes, rendered or recorded: "table1_..." and so on. Nothing for other plans.
[[nodiscard]] std::optional<PaperTable> paper_table_of(std::string_view plan);

/// @param runs of the plan of that table; ours is empty without any
[[nodiscard]] ReportTable paper_table(PaperTable table, std::span<const StoredRun> runs);

}  // namespace stillpoint
