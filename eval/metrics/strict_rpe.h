// SPDX-License-Identifier: BSD-3-Clause
/// Strict relative pose error: the RPE of relative_error.h over pairs of matches delta_s apart, with a
/// tolerance on the time difference, so that gaps and sparse estimates do not lower the error:
///
///   j = argmin_j |t_j - (t_i + delta_s)|;  pair (i, j) is used if
///   |t_j - (t_i + delta_s)| <= min(median(t_(k+1) - t_k) / 2, delta_s / 10)
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "eval/metrics/statistics.h"
#include "eval/trajectory/association.h"

namespace stillpoint::eval {

struct StrictRpe {
  Statistics translation_m;  ///< over delta_s
  Statistics rotation_deg;
};

/// `errors` is absent if no pair is left.
struct StrictRpeResult {
  std::optional<StrictRpe> errors;
  std::size_t dropped = 0;   ///< starts without an end within the tolerance
  double tolerance_s = 0.0;  ///< right-hand side of the condition above
};

/// Strict RPE as defined above. A run with one pose per 2.5 s has no pair for delta_s = 1. Starts less than
/// delta_s before the last match count as dropped, too.
[[nodiscard]] StrictRpeResult strict_rpe(std::span<const MatchedPose> matches, double delta_s);

/// Matches for the strict protocols: ground truth interpolated at the stamp of each estimated pose, between
/// neighbors that are both less than 0.11 s away (one interval at 10 Hz, plus jitter).
[[nodiscard]] std::vector<MatchedPose> strict_matches(const Trajectory& gt, const Trajectory& est,
                                                      double offset_s = 0.0);

}  // namespace stillpoint::eval
