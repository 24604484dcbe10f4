// SPDX-License-Identifier: BSD-3-Clause
/// Which commits changed a number, by how much, and which of these changes someone still has to look at.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/compare/commit_history.h"
#include "bench/store/acceptance.h"
#include "eval/statistics/change_points.h"
#include "eval/statistics/paired.h"

namespace stillpoint {

enum class ChangeState {
  kOpen,      ///< a regression: worse beyond the metric's margin, and so it is still
  kAccepted,  ///< someone gave a reason
  kEnded,     ///< was worse; the newest level is as good as the one before it
  kImproved,
  kNeutral,  ///< a metric without a good direction
};

/// "open", "accepted", "ended", "improved" or "neutral".
[[nodiscard]] std::string state_name(ChangeState state);

/// A number changed after one measured commit and up to the next.
struct LevelShift {
  std::size_t series = 0;     ///< index
  std::size_t before = 0;     ///< the last commit of the old level, an index
  std::size_t after = 0;      ///< the first commit of the new one
  double level_before = 0.0;  ///< medians of the segments to both sides
  double level_after = 0.0;
  std::optional<RelativeChange> change;  ///< none: runs that fail, and what was 0
  double p_value = 0.0;
  ChangeState state = ChangeState::kNeutral;
  std::string reason;  ///< of an acceptance
};

/// A number that moves by little at each commit, and by much over many.
struct Creep {
  std::size_t series = 0;
  std::size_t first = 0;  ///< the line's first and last commit
  std::size_t last = 0;
  double start = 0.0;  ///< the line's values there
  double end = 0.0;
  double change = 0.0;  ///< relative to its start
  double p_value = 1.0;
  bool worse = false;
};

struct HistoryChanges {
  std::vector<LevelShift> shifts;
  std::vector<Creep> creeps;
};

/// How far back changes are looked for: the time to look grows with the square of it. Older numbers are
/// shown.
inline constexpr std::size_t kJudgedCommits = 300;

/// Changes of all series, in their order. A change below its metric's margin or floor (`metric_rule`), or
/// whose 95 % interval holds 0, is none. Runs that fail need no test: they have regressed when the newest
/// commit fails more than an earlier one.
[[nodiscard]] HistoryChanges history_changes(const CommitHistory& history,
                                             std::span<const Acceptance> acceptances,
                                             const ChangePointOptions& options = {});

}  // namespace stillpoint
