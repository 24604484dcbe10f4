// SPDX-License-Identifier: BSD-3-Clause
/// Result tables: metrics by variant and sequence, module times by variant, comparisons with published
/// results.
#pragma once

#include <span>
#include <vector>

#include "bench/model/stored_run.h"
#include "bench/systems/published_table.h"
#include "reports/tables/report_table.h"

namespace stillpoint::report {

/// One table per metric that occurs in any run, most important first; excludes sweeps.
[[nodiscard]] std::vector<ReportTable> metric_tables(std::span<const bench::StoredRun> runs);

/// Mean time of each module [ms], median over the runs of a variant; no rows without timings.
[[nodiscard]] ReportTable cost_table(std::span<const bench::StoredRun> runs);

/// Published rows above measured ones, on the sequences (or modules) they share; no rows if there are none.
[[nodiscard]] ReportTable published_comparison_table(std::span<const bench::StoredRun> runs,
                                                     const bench::PublishedTable& published);

}  // namespace stillpoint::report
