// SPDX-License-Identifier: BSD-3-Clause
/// Relative pose of two cameras from bearings by the five-point algorithm. Nister 2004; Qin et al. 2018,
/// Sec. V-A.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose.h"

namespace stillpoint {

/// One point in two cameras, on the normalized image plane.
struct BearingPair {
  Eigen::Vector2d first;
  Eigen::Vector2d second;
};

struct RelativePose {
  Pose T_first_second;  ///< up to scale: |p| = 1
  int inliers = 0;      ///< pairs that satisfy the epipolar constraint, in front of both cameras
};

/// RANSAC with a fixed seed (deterministic). The result is meaningless without parallax.
/// @param threshold largest distance to the epipolar line [normalized image plane], > 0
/// @return nothing if there are fewer than max(`min_inliers`, 5) pairs or fewer than `min_inliers` inliers
[[nodiscard]] std::optional<RelativePose> estimate_relative_pose(const std::vector<BearingPair>& pairs,
                                                                 double threshold, int min_inliers);

}  // namespace stillpoint
