// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/pose_pairs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stillpoint::eval {

double strict_tolerance_s(MatchView matches, double delta_s) {
  constexpr double kMaxDeltaFraction = 0.1;
  std::vector<double> intervals;
  intervals.reserve(matches.size());
  for (std::size_t i = 1; i < matches.size(); ++i)
    intervals.push_back(seconds_between(matches.time(i - 1), matches.time(i)));
  return std::min(0.5 * percentile(intervals, 0.5).value_or(0.0), kMaxDeltaFraction * delta_s);
}

PosePairs strict_pairs(MatchView matches, double delta, RpeUnit unit) {
  constexpr double kAngleTolerance = 0.1;  // relative to delta
  switch (unit) {
    case RpeUnit::kSeconds:
      return pairs_over_seconds(matches, delta, strict_tolerance_s(matches, delta));
    case RpeUnit::kFrames:
      return {.pairs = pairs_over_frames(matches.size(),
                                         static_cast<std::size_t>(std::max(1L, std::lround(delta))), true)};
    case RpeUnit::kMeters:
      return pairs_over_meters(path_lengths(matches, PathOf::kGroundTruth), delta, kSegmentTolerance * delta);
    case RpeUnit::kDegrees:
      break;
  }
  return pairs_over_meters(path_angles_deg(matches), delta, kAngleTolerance * delta);
}

std::vector<double> point_distance_errors(MatchView matches, std::span<const PosePair> pairs) {
  std::vector<double> errors_m;
  errors_m.reserve(pairs.size());
  for (const auto& [begin, end] : pairs) {
    const MatchedPose from = matches[begin];
    const MatchedPose to = matches[end];
    errors_m.push_back(std::abs((to.gt.p - from.gt.p).norm() - (to.est.p - from.est.p).norm()));
  }
  return errors_m;
}

double whole_transformation_error(double translation_m, double rotation_deg) {
  return std::hypot(translation_m, std::sqrt(8.0) * std::sin(0.5 * rotation_deg * std::numbers::pi / 180.0));
}

}  // namespace stillpoint::eval
