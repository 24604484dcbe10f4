// SPDX-License-Identifier: BSD-3-Clause
/// How well vision determines the newest camera pose.
#pragma once

#include <vector>

#include "core/backend/start/camera_pose.h"

namespace stillpoint {

/// Information of static points of known position about a camera pose. With the Jacobians J_k of the bearings
/// by the pose and their standard deviation s,
///
///   H = sum over inliers k of J_k^T J_k / s^2,    covariance = H^-1.
struct VisionAssessment {
  int features = 0;        ///< static features in the newest frame whose position is known
  int inliers = 0;         ///< of those, with a small reprojection error
  double sigma_m = 1e3;    ///< standard deviation of the position along its least certain direction
  double sigma_rad = 1e3;  ///< same for the rotation

  /// At least eight inliers, and three tenths of all, or one tenth if inertial data agree with the pose,
  /// because the others may belong to moving objects: otherwise the pose is not that of the camera.
  [[nodiscard]] bool is_located(bool inertial) const;
  /// Located by few features, or with an uncertain direction.
  [[nodiscard]] bool has_few_features() const;
  [[nodiscard]] bool has_weak_geometry() const;
};

/// @param bearing_sigma standard deviation s of a bearing; inliers are within five times of it
[[nodiscard]] VisionAssessment assess_vision(const std::vector<PointObservation>& points, const Pose& T_w_c,
                                             double bearing_sigma);

}  // namespace stillpoint
