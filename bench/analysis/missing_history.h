// SPDX-License-Identifier: BSD-3-Clause
/// Results that a history no longer has at its newest commits; see bench/analysis/history_changes.h.
#pragma once

#include <vector>

#include "bench/analysis/commit_history.h"
#include "bench/analysis/history_changes.h"

namespace stillpoint::bench {

/// Open shifts without a new level: `level_after` is not a number, `missing` says why.
[[nodiscard]] std::vector<LevelShift> missing_shifts(const CommitHistory& history);

}  // namespace stillpoint::bench
