// SPDX-License-Identifier: BSD-3-Clause
/// Stored runs gathered into cells of tables.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/store/stored_run.h"
#include "reports/tables/report_table.h"

namespace stillpoint {

/// How readers know what made a run: the variant of our odometry, or the name of another system.
[[nodiscard]] std::string system_label(const RunIdentity& identity);

/// Distinct values in the order of first appearance.
[[nodiscard]] std::vector<std::string> distinct(std::span<const StoredRun> runs,
                                                const std::function<std::string(const RunIdentity&)>& name);

/// A number of a run, nothing if the run has none.
using RunNumber = std::function<std::optional<double>(const StoredRun&)>;

/// Median over the runs that ended well, and what became of the others.
/// @param runs of one thing; none give an empty cell
[[nodiscard]] TableCell run_cell(const std::vector<const StoredRun*>& runs, const RunNumber& number);

/// `run_cell` over a metric, with its recipe.
[[nodiscard]] TableCell metric_cell(const std::vector<const StoredRun*>& runs, const std::string& metric);

/// `run_cell` over the mean time of a module.
[[nodiscard]] TableCell cost_cell(const std::vector<const StoredRun*>& runs, const std::string& module);

/// Whether the times of a run are to be told: those of timed runs where its label has any, because others
/// share the machine with runs beside them.
[[nodiscard]] bool tells_times(std::span<const StoredRun> runs, const StoredRun& run);

/// Those of a label, outside sweeps, whose times are to be told.
[[nodiscard]] std::vector<const StoredRun*> timed_runs_of(std::span<const StoredRun> runs,
                                                          const std::string& label);

/// Those of a label on a sequence, outside sweeps; an empty sequence matches all.
[[nodiscard]] std::vector<const StoredRun*> runs_of(std::span<const StoredRun> runs, const std::string& label,
                                                    const std::string& sequence);

}  // namespace stillpoint
