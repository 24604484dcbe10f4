// SPDX-License-Identifier: BSD-3-Clause
/// A history of metrics over commits as text: labels of commits, subjects and changes, JSON data of the
/// dashboard, and the list of open regressions as Markdown and as JSON for CI.
#pragma once

#include <string>
#include <vector>

#include "bench/analysis/history_changes.h"

namespace stillpoint::report {

/// Short commit name: ten digits of the hash, plus a suffix that starts with "+"; at most 24 characters.
[[nodiscard]] std::string commit_label(const std::string& name);

/// "vo on office", followed by non-default sweep point, seed, mode, kind and cores.
[[nodiscard]] std::string subject_label(const bench::HistorySubject& subject);

/// "+5.2 %", or "new" if there is no earlier level.
[[nodiscard]] std::string change_label(const bench::LevelShift& shift);

/// "n = 8, +4.1 to +6.0 %", the 95 % interval, or "n = 3, no interval"; n: commits of the shorter level.
/// Empty without a relative change.
[[nodiscard]] std::string interval_label(const bench::LevelShift& shift);

/// Four significant digits and the unit.
[[nodiscard]] std::string value_label(double value, const std::string& unit);

/// Path of a commit's page relative to the dashboard; contains only [A-Za-z0-9./-] for any commit name.
[[nodiscard]] std::string commit_file(const bench::Commit& commit);

/// Distinct subjects in the order of the series; series of one subject are contiguous.
[[nodiscard]] std::vector<bench::HistorySubject> subjects_of(const bench::CommitHistory& history);

/// JSON: commits, plans, machines, subjects, series, shifts, drifts and tooltips of metrics; they refer to
/// each other by index.
[[nodiscard]] std::string dashboard_data(const bench::CommitHistory& history,
                                         const bench::HistoryChanges& changes);

/// All shifts of one metric between the same two commits, over all subjects.
struct ShiftGroup {
  std::string metric;
  std::size_t before = 0;  ///< commit indices, as in `LevelShift`
  std::size_t after = 0;
  std::vector<const bench::LevelShift*> shifts;  ///< the largest first
};

/// In the order of `bench::precedes`: failures, accuracy, cost; by falling size in margins.
[[nodiscard]] std::vector<ShiftGroup> grouped_shifts(const bench::CommitHistory& history,
                                                     const bench::HistoryChanges& changes,
                                                     bench::ChangeState state);

/// Whether there is an open regression or an open drift for the worse.
[[nodiscard]] bool has_findings(const bench::CommitHistory& history, const bench::HistoryChanges& changes);

/// What the history can show: number of series and commits, and of series that are too short for noisy
/// metrics.
[[nodiscard]] std::string tested_sentence(const bench::CommitHistory& history);

/// For a merge request: what changed in one line, tables of open regressions, drifts for the worse and
/// suspected changes, and the number of comparisons.
[[nodiscard]] std::string regressions_markdown(const bench::CommitHistory& history,
                                               const bench::HistoryChanges& changes);

/// {"open": [...], "drifting": [...]}: one entry per series.
[[nodiscard]] std::string regressions_json(const bench::CommitHistory& history,
                                           const bench::HistoryChanges& changes);

}  // namespace stillpoint::report
