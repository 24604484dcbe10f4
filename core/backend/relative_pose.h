// SPDX-License-Identifier: BSD-3-Clause
/// Relative pose of two cameras from bearings alone: the five-point algorithm. Nister 2004; Qin et al. 2018,
/// Sec. V-A.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose.h"

namespace stillpoint {

/// One point in two cameras, on the normalised plane.
struct BearingPair {
  Eigen::Vector2d first;
  Eigen::Vector2d second;
};

struct RelativePose {
  Pose T_first_second;  ///< the distance is unknown: |p| = 1
  int inliers = 0;      ///< pairs on their epipolar line and before both cameras
};

/// RANSAC with a fixed seed of its own: same input, same answer. Without parallax the answer means nothing.
/// @param threshold of the distance to the epipolar line [normalised plane], > 0
/// @return nothing if there are fewer than `min_inliers` inliers, of which five points need at least 5
[[nodiscard]] std::optional<RelativePose> estimate_relative_pose(const std::vector<BearingPair>& pairs,
                                                                 double threshold, int min_inliers);

}  // namespace stillpoint
