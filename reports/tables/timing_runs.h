// SPDX-License-Identifier: BSD-3-Clause
/// Selects the runs whose times are shown: undisturbed timing runs where there are any.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/model/run_notes.h"
#include "bench/model/stored_run.h"
#include "reports/tables/report_table.h"

namespace stillpoint::report {

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
