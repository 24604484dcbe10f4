// SPDX-License-Identifier: BSD-3-Clause
/// List of open regressions as Markdown and as JSON for CI.
#pragma once

#include <string>
#include <vector>

#include "bench/analysis/history_changes.h"

namespace stillpoint::report {

/// All shifts of one metric between the same two commits, over all subjects.
struct ShiftGroup {
  std::string metric;
  std::size_t before = 0;  ///< commit indices, as in `LevelShift`
  std::size_t after = 0;
  std::vector<const bench::LevelShift*> shifts;  ///< the largest first
};

/// Newest commit first; within a commit failures first, then by falling change.
[[nodiscard]] std::vector<ShiftGroup> grouped_shifts(const bench::CommitHistory& history,
                                                     const bench::HistoryChanges& changes,
                                                     bench::ChangeState state);

/// A table of open regressions, followed by metrics that drift for the worse.
[[nodiscard]] std::string regressions_markdown(const bench::CommitHistory& history,
                                               const bench::HistoryChanges& changes);

/// {"open": [...], "drifting": [...]}: one entry per series.
[[nodiscard]] std::string regressions_json(const bench::CommitHistory& history,
                                           const bench::HistoryChanges& changes);

}  // namespace stillpoint::report
