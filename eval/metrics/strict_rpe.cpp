// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/strict_rpe.h"

#include <algorithm>
#include <vector>

#include "eval/metrics/relative_error.h"

namespace stillpoint::eval {

StrictRpeResult strict_rpe(std::span<const MatchedPose> matches, double delta_s) {
  constexpr double kMaxDeltaFraction = 0.1;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < matches.size(); ++i) {
    intervals.push_back(seconds_between(matches[i - 1].t, matches[i].t));
  }
  StrictRpeResult result;
  result.tolerance_s = std::min(0.5 * percentile(intervals, 0.5).value_or(0.0), kMaxDeltaFraction * delta_s);
  const PosePairs found = pairs_over_seconds(matches, delta_s, result.tolerance_s);
  const RelativeErrors errors = relative_errors(matches, found.pairs);
  result.dropped = found.dropped;
  if (!found.pairs.empty()) {
    result.errors = StrictRpe{*statistics(errors.translation_m), *statistics(errors.rotation_deg)};
  }
  return result;
}

std::vector<MatchedPose> strict_matches(const Trajectory& gt, const Trajectory& est, double offset_s) {
  constexpr double kMaxGap = 0.11;  // [s]
  return matched_poses(gt, est, associate_interpolated(gt, est, kMaxGap, offset_s));
}

}  // namespace stillpoint::eval
