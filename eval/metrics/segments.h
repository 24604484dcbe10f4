// SPDX-License-Identifier: BSD-3-Clause
/// Relative errors over stretches of the path, as in the boxplots of Zhang and Scaramuzza, IROS 2018.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "eval/metrics/statistics.h"
#include "eval/trajectory/association.h"

namespace stillpoint {

/// Errors of all stretches of one length; quartiles for boxplots.
struct SegmentErrors {
  double length_m = 0.0;
  Statistics translation_m;
  Statistics rotation_deg;
  Statistics yaw_deg;
  double translation_lower_quartile_m = 0.0;
  double translation_upper_quartile_m = 0.0;
  std::size_t dropped = 0;  ///< starts without an end within tolerance
};

struct SegmentOptions {
  std::vector<double> lengths_m;  ///< empty: 10, 20, 30, 40, 50 % of the ground truth's path
  double tolerance = 0.02;        ///< of the length
  /// Give the k-th end that was found to the k-th start, even if starts before it had none: what
  /// rpg_trajectory_evaluation does after a gap.
  bool shift_starts = false;
};

/// Lengths without any stretch are left out. `matches` are aligned.
[[nodiscard]] std::vector<SegmentErrors> segment_errors(std::span<const MatchedPose> matches,
                                                        const SegmentOptions& options);

/// Mean over all stretches of error / length, in percent.
[[nodiscard]] std::optional<double> drift_percent(std::span<const SegmentErrors> segments);

}  // namespace stillpoint
