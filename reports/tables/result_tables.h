// SPDX-License-Identifier: BSD-3-Clause
/// The tables of any benchmark: each metric by variant and sequence, and the time of each module by variant.
#pragma once

#include <span>
#include <vector>

#include "bench/store/stored_run.h"
#include "bench/systems/published_table.h"
#include "reports/tables/report_table.h"

namespace stillpoint {

/// One table for each metric that some run has, in the order of importance; runs of sweeps are left out.
[[nodiscard]] std::vector<ReportTable> metric_tables(std::span<const StoredRun> runs);

/// Mean time of each module [ms], medians over the runs of a variant; no rows without timings.
[[nodiscard]] ReportTable cost_table(std::span<const StoredRun> runs);

/// Quoted numbers over measured ones, on the sequences (or modules) that both have; no rows if they share
/// none.
[[nodiscard]] ReportTable beside_table(std::span<const StoredRun> runs, const PublishedTable& published);

}  // namespace stillpoint
