// SPDX-License-Identifier: BSD-3-Clause
/// The regressions that someone still has to look at, for people and for CI.
#pragma once

#include <string>
#include <vector>

#include "bench/compare/history_changes.h"

namespace stillpoint {

/// One metric that changed at one commit, on whatever it changed.
struct ShiftGroup {
  std::string metric;
  std::size_t before = 0;  ///< commits, as in `LevelShift`
  std::size_t after = 0;
  std::vector<const LevelShift*> shifts;  ///< the largest first
};

/// The newest commit first; of one commit what fails, then the largest change.
[[nodiscard]] std::vector<ShiftGroup> grouped_shifts(const CommitHistory& history,
                                                     const HistoryChanges& changes, ChangeState state);

/// A table of open regressions, and what creeps for the worse below it.
[[nodiscard]] std::string regressions_markdown(const CommitHistory& history, const HistoryChanges& changes);

/// {"open": [...], "creeping": [...]}: every series by itself.
[[nodiscard]] std::string regressions_json(const CommitHistory& history, const HistoryChanges& changes);

}  // namespace stillpoint
