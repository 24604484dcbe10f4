// SPDX-License-Identifier: BSD-3-Clause
/// Monocular structure from motion over the window. Qin et al. 2018 (VINS-Mono), Sec. V-A. The relative pose
/// of the first two cameras is found by the five-point algorithm (Nister 2004).
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/backend/solvers/window_solver.h"
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

/// Estimates all camera poses and the landmarks with sufficient parallax, up to scale (median depth about 1).
///
/// 1. Reference: the first frame with enough common features and parallax with the newest frame; relative
///    pose by the five-point algorithm; triangulation of the common features.
/// 2. The frames in between, then the older ones, are localized by PnP; new points are triangulated on the
///    way.
/// 3. Bundle adjustment.
///
/// Gyroscope data are used only to compensate rotation in the parallax and to predict rotations for PnP.
/// @param window every frame but the first with inertial samples; its poses and depths are not used
/// @param focal_px focal length of the camera, converts pixels to bearings
/// @param solver for the bundle adjustment
/// @return the window in the frame of the reference camera; nothing if the parallax is insufficient or a step
/// fails
[[nodiscard]] std::optional<Window> reconstruct_window(const Window& window, const BackendConfig& config,
                                                       double focal_px, WindowSolver& solver);

}  // namespace stillpoint
