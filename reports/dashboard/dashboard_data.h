// SPDX-License-Identifier: BSD-3-Clause
/// JSON data of the dashboard.
#pragma once

#include <string>
#include <vector>

#include "bench/analysis/history_changes.h"

namespace stillpoint::report {

/// Path of a commit's page relative to the dashboard; contains only [A-Za-z0-9./-] for any commit name.
[[nodiscard]] std::string commit_file(const bench::Commit& commit);

/// Distinct subjects in the order of the series; series of one subject are contiguous.
[[nodiscard]] std::vector<bench::HistorySubject> subjects_of(const bench::CommitHistory& history);

/// JSON: commits, plans, machines, subjects, series, shifts, drifts and tooltips of metrics; they refer to
/// each other by index.
[[nodiscard]] std::string dashboard_data(const bench::CommitHistory& history,
                                         const bench::HistoryChanges& changes);

}  // namespace stillpoint::report
