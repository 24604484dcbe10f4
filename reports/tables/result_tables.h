// SPDX-License-Identifier: BSD-3-Clause
/// Result tables: metrics by variant and sequence, module times by variant, a metric on all sequences of a
/// dataset with published systems beside ours, and measured and published results in one table.
#pragma once

#include <span>
#include <string>
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

/// What the table of a dataset shows.
struct DatasetTableLayout {
  std::string name;  ///< base name of the files
  std::string title;
  std::vector<std::string> sequences;  ///< of the plan; also those without data
  std::vector<std::string> variants;   ///< of the plan
};

/// A metric on all sequences of a dataset, one row per sequence, published systems beside ours. Sequences
/// without data are rows without numbers. The last row contains the mean of each column over the
/// sequences with a number; a note states how many these are.
/// @param published may have no rows; its metric selects the numbers of the runs
[[nodiscard]] ReportTable dataset_table(const DatasetTableLayout& layout,
                                        std::span<const bench::StoredRun> runs,
                                        const bench::PublishedTable& published);

/// A Markdown table with one column per sequence (or module): measured medians first, then the published rows
/// that share a column, followed by sources, notes and limits of comparability. Times are those of
/// undisturbed timing runs only. Empty without shared columns, except for a line that names the omitted
/// times.
[[nodiscard]] std::string published_comparison(std::span<const bench::StoredRun> runs,
                                               const bench::PublishedTable& published);

}  // namespace stillpoint::report
