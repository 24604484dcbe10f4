// SPDX-License-Identifier: BSD-3-Clause
/// Motion of the camera between two pictures from points of known depth.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "core/geometry/pose.h"

namespace stillpoint {

struct PointObservation {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< in the earlier camera [m]
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();  ///< in the later one, normalised plane
};

struct RigidMotionSettings {
  double threshold = 0.002;  ///< misfit of an inlier [normalised plane]
  double confidence = 0.99;  ///< of having drawn one clean sample
};

/// The later camera's pose relative to the earlier one (coordinates in the earlier to the later): RANSAC over
/// samples of four, then Gauss-Newton on all observations with Cauchy weights (Holland and Welsch 1977). The
/// refinement matters: a pose from four noisy points throws out good matches. Samples too are solved by
/// Gauss-Newton, from no motion: between two pictures there is little. Deterministic; allocates nothing.
/// @return nothing with fewer than four observations, or when RANSAC finds no pose
[[nodiscard]] std::optional<Pose> estimate_rigid_motion(std::span<const PointObservation> observations,
                                                        const RigidMotionSettings& settings);

}  // namespace stillpoint
