// SPDX-License-Identifier: BSD-3-Clause
/// Geometric verification of a recognized place.
#pragma once

#include "core/config/loop_config.h"
#include "core/geometry/camera.h"
#include "core/loop/keyframe.h"
#include "core/types/loop_report.h"

namespace stillpoint {

/// A candidate with its relative pose.
struct VerifiedLoop {
  LoopRecord record;                     ///< `kAccepted` if the geometry is good
  Pose T_bm_bq;                          ///< of the bodies
  Matrix6 covariance = Matrix6::Zero();  ///< of `T_bm_bq`: p + d, q * Exp(theta)
};

/// Matches the features of two keyframes and estimates their relative pose by RANSAC, see
/// relative_pose_estimation.h. Refused are candidates with too few matches or inliers, inliers on a small
/// part of either image, and poses with a standard deviation above 0.05 m or 1 degree. The seed is the frame
/// of the query. The covariance includes 1 cm and 0.2 degrees, 3 % of the translation and 2 % of the
/// rotation, as errors of depth and calibration are correlated.
[[nodiscard]] VerifiedLoop verify_loop(const Keyframe& query, const Keyframe& match, const Camera& camera,
                                       const LoopConfig& config);

}  // namespace stillpoint
