// SPDX-License-Identifier: BSD-3-Clause
/// Relative pose error that neither a gap nor a sparse estimate can flatter.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "eval/metrics/statistics.h"
#include "eval/trajectory/association.h"

namespace stillpoint {

struct StrictRpe {
  Statistics translation_m;  ///< over delta_s
  Statistics rotation_deg;
};

/// `errors` is absent when no pair is left: "n/a", never 0.
struct StrictRpeResult {
  std::optional<StrictRpe> errors;
  std::size_t dropped = 0;  ///< starts without an end at the right distance
  double tolerance_s = 0.0;
};

/// Every start is paired with the match nearest to `delta_s` later, and dropped when that is off by more than
/// half the median interval of the matches, or by more than a tenth of delta_s: a run with one pose per 2.5 s
/// has no 1 s motion to show. Starts within delta_s of the end count as dropped too.
[[nodiscard]] StrictRpeResult strict_rpe(std::span<const MatchedPose> matches, double delta_s);

/// Matches for strict recipes: ground truth interpolated at each estimate, between neighbours nearer than
/// 0.11 s (one interval at 10 Hz with slack).
[[nodiscard]] std::vector<MatchedPose> strict_matches(const Trajectory& gt, const Trajectory& est,
                                                      double offset_s = 0.0);

}  // namespace stillpoint
