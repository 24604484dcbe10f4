// SPDX-License-Identifier: BSD-3-Clause
/// Scores a run with the default protocols: ATE, RPE, correct rate, coverage. The metrics of a result file
/// are computed from it, see bench/model/metrics.h.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "eval/metrics/ate.h"
#include "eval/metrics/rpe.h"

namespace stillpoint::eval {

struct ScoreOptions {
  double max_difference_s = 0.02;  ///< of associated stamps, for the ATE
  double rpe_delta_s = 1.0;
  double offset_s = 0.0;  ///< added to the estimate's stamps
  /// A pose is correct within 1 m and 30 degrees: the lifelong thresholds of OpenLORIS for its office scene,
  /// the strictest ones.
  CorrectRateOptions correct{.max_translation_m = 1.0, .max_rotation_deg = 30.0};
  /// Frame times of the sequence. If empty, coverage is "n/a" and the time to the first pose is measured from
  /// the start of the ground truth.
  std::vector<Timestamp> expected_times;
  double coverage_tolerance_s = 1e-3;  ///< > rounding of stamps in files with 6 decimals
};

/// nullopt means "n/a": there is no data for the metric. A run without poses has the correct rate 0.
struct Score {
  std::optional<AteResult> ate;  ///< TUM: 20 ms, one-to-one, SE(3) alignment
  std::optional<RpeResult> rpe;  ///< TUM: errors over `rpe_delta_s`, fixed delta
  double rpe_delta_s = 1.0;
  std::optional<double> correct_rate;
  std::optional<double> coverage;      ///< fraction of the expected frames with a pose
  std::optional<double> first_pose_s;  ///< time from the first frame to the first pose
  std::size_t poses = 0;               ///< of the estimate
};

/// @param gt, est poses of the same body frame (see `move_to_frame`) with strictly increasing stamps; either
/// may be empty
/// @param options the defaults give the metrics of the result file
[[nodiscard]] Score score(const Trajectory& gt, const Trajectory& est, const ScoreOptions& options = {});

/// That most poses of an estimate have no true pose, and what its errors are then; empty if they have.
/// @param gt ground truth of the score
/// @param score with the default limit of the stamps
[[nodiscard]] std::string sparse_truth_doubt(const Trajectory& gt, const Score& score);

}  // namespace stillpoint::eval
