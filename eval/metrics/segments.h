// SPDX-License-Identifier: BSD-3-Clause
/// Relative errors over segments (sub-trajectories) of fixed length, as in Zhang and Scaramuzza, IROS 2018:
/// trans, rot and yaw of relative_error.h over pairs (k, m) with m = argmin_m |s_m - (s_k + d)|, where s is
/// the path length of the ground truth and d the length of the segment.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "eval/metrics/statistics.h"
#include "eval/trajectory/association.h"

namespace stillpoint::eval {

/// Errors of all segments of one length; quartiles for box plots.
struct SegmentErrors {
  double length_m = 0.0;
  Statistics translation_m;
  Statistics rotation_deg;
  Statistics yaw_deg;
  double translation_lower_quartile_m = 0.0;
  double translation_upper_quartile_m = 0.0;
  std::size_t dropped = 0;  ///< starts without an end within the tolerance
};

struct SegmentOptions {
  std::vector<double> lengths_m;  ///< empty: 10, 20, 30, 40, 50 % of the ground truth's path length
  double tolerance = 0.02;        ///< on |s_m - (s_k + d)|, relative to d
  /// Assign the k-th end found to start k even if earlier starts have no end, as rpg_trajectory_evaluation
  /// does.
  bool shift_starts = false;
};

/// @param matches aligned
/// @param options lengths of the segments and how their ends are found
/// @return one entry per length that has at least one segment
[[nodiscard]] std::vector<SegmentErrors> segment_errors(std::span<const MatchedPose> matches,
                                                        const SegmentOptions& options);

/// Drift: mean over all segments of |p(F_km)| / d, in percent.
[[nodiscard]] std::optional<double> drift_percent(std::span<const SegmentErrors> segments);

}  // namespace stillpoint::eval
