// SPDX-License-Identifier: BSD-3-Clause
/// Runs as one table for statistics programs: a row per run and metric.
#pragma once

#include <span>
#include <string>

#include "bench/model/stored_run.h"
#include "reports/tables/data_table.h"

namespace stillpoint::report {

/// The columns, separated by commas.
[[nodiscard]] std::string tidy_header();

/// CSV (RFC 4180) with the columns of `tidy_header`: what identifies the run, its outcome, and one metric
/// with its unit, the protocol that it was measured by, whether smaller or larger is better ("smaller",
/// "larger" or empty), and its value with all digits ("inf" and "nan" for values that are none). Each run has
/// the metric "succeeded", 1 or 0, so that a failed run, which may have no other, is not missing from the
/// table; and the mean, median, 95th percentile and maximum of each timed module, as "median_ms/MODULE".
[[nodiscard]] std::string tidy_text(std::span<const bench::StoredRun> runs);

/// The same rows with typed values; of few runs, as it needs a kilobyte per row.
[[nodiscard]] DataTable tidy_table(std::span<const bench::StoredRun> runs);

}  // namespace stillpoint::report
