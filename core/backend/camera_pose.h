// SPDX-License-Identifier: BSD-3-Clause
/// Pose of one camera from points of the world that it sees: RANSAC over minimal samples, then robust
/// refinement.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose.h"

namespace stillpoint {

struct PointSighting {
  Eigen::Vector3d p_w;      ///< [m]
  Eigen::Vector2d bearing;  ///< normalised plane
};

struct CameraPoseOptions {
  double inlier_threshold = 0.01;  ///< [normalised plane]
  int iterations = 60;             ///< RANSAC hypotheses
  int min_inliers = 8;
  std::uint32_t seed = 1;
};

struct CameraPose {
  Pose T_w_c;
  int inliers = 0;
};

/// @param prediction where the camera is expected; hypotheses start from it, so it should be right to about
/// 20 degrees
/// @return nothing if fewer than `min_inliers` agree on a pose
[[nodiscard]] std::optional<CameraPose> estimate_camera_pose(const std::vector<PointSighting>& sightings,
                                                             const Pose& prediction,
                                                             const CameraPoseOptions& options);

}  // namespace stillpoint
