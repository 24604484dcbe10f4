// SPDX-License-Identifier: BSD-3-Clause
/// Measured and published results in one table: one row per system, marked by source.
#pragma once

#include <span>
#include <string>

#include "bench/model/stored_run.h"
#include "bench/systems/published_table.h"

namespace stillpoint::report {

/// A Markdown table with one column per sequence (or module): measured medians first, then the published rows
/// that share a column, followed by sources, notes and limits of comparability. Times are those of
/// undisturbed timing runs only. Empty without shared columns, except for a line that names the omitted
/// times.
[[nodiscard]] std::string published_comparison(std::span<const bench::StoredRun> runs,
                                               const bench::PublishedTable& published);

}  // namespace stillpoint::report
