// SPDX-License-Identifier: BSD-3-Clause
/// What the scripts of the dashboard read.
#pragma once

#include <string>
#include <vector>

#include "bench/compare/history_changes.h"

namespace stillpoint {

/// File of a commit's page below the dashboard, of harmless letters whatever the commit's name.
[[nodiscard]] std::string commit_file(const Commit& commit);

/// Subjects in the order of the series: those of one subject follow each other.
[[nodiscard]] std::vector<HistorySubject> subjects_of(const CommitHistory& history);

/// JSON: commits, plans, machines, subjects, series, shifts and creeps, which name each other by their
/// indices.
[[nodiscard]] std::string dashboard_data(const CommitHistory& history, const HistoryChanges& changes);

}  // namespace stillpoint
