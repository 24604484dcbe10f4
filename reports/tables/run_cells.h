// SPDX-License-Identifier: BSD-3-Clause
/// Aggregates stored runs into table cells, and selects the runs whose times are shown: undisturbed timing
/// runs where there are any.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/model/run_notes.h"
#include "bench/model/stored_run.h"
#include "reports/tables/report_table.h"

namespace stillpoint::report {

/// Display name of the system under test: the variant of Stillpoint, or the name of another system.
[[nodiscard]] std::string system_label(const bench::RunIdentity& identity);

/// Distinct values in the order of first appearance.
[[nodiscard]] std::vector<std::string> distinct(
    std::span<const bench::StoredRun> runs,
    const std::function<std::string(const bench::RunIdentity&)>& name);

/// Names of the sequences in the order of first appearance.
[[nodiscard]] std::vector<std::string> sequences_of(std::span<const bench::StoredRun> runs);

/// The cell with another remark in its footnote; an empty remark changes nothing.
[[nodiscard]] TableCell with_note(TableCell cell, const std::string& note);

/// Median of a metric over the successful runs, with a note about the failed ones; over its replicates (see
/// `bench::metric_spread`), with its protocol, and footnotes where a strict protocol gives a very different
/// value, recorded boxes are missing, or a value is infinite.
/// @param runs repetitions of one benchmark case; an empty list gives an empty cell
[[nodiscard]] TableCell metric_cell(const std::vector<const bench::StoredRun*>& runs,
                                    std::string_view metric);

/// The mean of cells that all have a number; else an empty cell. It is suspicious if one of them is.
[[nodiscard]] TableCell mean_cell(std::span<const TableCell> cells);

/// Runs of a label on a sequence, outside sweeps; an empty sequence matches all.
[[nodiscard]] std::vector<const bench::StoredRun*> runs_of(std::span<const bench::StoredRun> runs,
                                                           const std::string& label,
                                                           const std::string& sequence);

/// Runs of one variant that have the same source of times.
struct TimedRuns {
  std::vector<const bench::StoredRun*> runs;
  bench::TimeSource source = bench::TimeSource::kShared;
};

/// Of `runs`, those with the best source of times that a successful run has, and the failed timing runs; all
/// runs if none is a successful timing run.
[[nodiscard]] TimedRuns timed_runs(const std::vector<const bench::StoredRun*>& runs);

/// `timed_runs` of a label outside sweeps.
[[nodiscard]] TimedRuns timed_runs_of(std::span<const bench::StoredRun> runs, const std::string& label);

/// Mean time of a module over `timed_runs_of`; times that are not undisturbed have a footnote.
[[nodiscard]] TableCell time_cell(const TimedRuns& timed, const std::string& module);

/// As `time_cell`, but empty, with the remedy as a footnote, unless the times are undisturbed.
[[nodiscard]] TableCell undisturbed_time_cell(const TimedRuns& timed, const std::string& module);

/// Whether the times of a run are shown among those of its label, inside or outside sweeps.
[[nodiscard]] bool has_shown_times(std::span<const bench::StoredRun> runs, const bench::StoredRun& run);

/// One sentence for each source of times that needs a restriction: the labels, and the restriction.
[[nodiscard]] std::vector<std::string> time_source_sentences(std::span<const bench::StoredRun> runs);

}  // namespace stillpoint::report
