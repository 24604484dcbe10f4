// SPDX-License-Identifier: BSD-3-Clause
/// The numbers that a run's result file carries, from one call.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "eval/metrics/coverage.h"

namespace stillpoint {

struct ScoreOptions {
  double max_difference_s = 0.02;  ///< association of the ATE
  double rpe_delta_s = 1.0;
  double offset_s = 0.0;  ///< added to the estimate's stamps
  /// Correct means within 1 m and 30 degrees: OpenLORIS' strictest lifelong thresholds, those of its office.
  CorrectRateOptions correct{.max_translation_m = 1.0, .max_rotation_deg = 30.0};
  /// Frame times of the sequence; empty: coverage is "n/a" and the first pose counts from the ground truth's
  /// start.
  std::vector<Timestamp> expected_times;
  double coverage_tolerance_s = 1e-3;  ///< files with 6 decimals round stamps
};

/// Nothing means "n/a": there are no data for the number. It is never 0 for want of data; the correct rate of
/// a run without poses is a true 0.
struct Score {
  std::optional<double> ate_rmse_m;              ///< TUM: 20 ms, one-to-one, rigid alignment
  std::optional<double> rpe_trans_rmse_m_per_s;  ///< TUM: fixed delta of 1 s
  std::optional<double> rpe_rot_rmse_deg_per_s;
  std::optional<double> correct_rate;
  std::optional<double> coverage;
  std::optional<double> first_pose_s;
  std::size_t ate_pairs = 0;
  std::size_t rpe_pairs = 0;
  std::size_t poses = 0;  ///< of the estimate
};

/// @param gt, est poses of the same frame of the robot (see `move_to_frame`), strictly rising stamps; either
/// may be empty
[[nodiscard]] Score score(const Trajectory& gt, const Trajectory& est, const ScoreOptions& options = {});

}  // namespace stillpoint
