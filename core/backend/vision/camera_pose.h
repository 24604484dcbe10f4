// SPDX-License-Identifier: BSD-3-Clause
/// Camera pose from 3D-2D correspondences (PnP): RANSAC over small samples, then robust refinement.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/backend/window/window.h"
#include "core/config/backend_config.h"

namespace stillpoint {

/// T_a_c = T_a_b T_b_c, by a call of the operator. Inlined, g++ would fuse other products and sums, so that
/// the last bits of a prediction would depend on the sources that are compiled together.
[[nodiscard]] Pose product(const Pose& T_a_b, const Pose& T_b_c);

/// A point in the world and its observed bearing.
struct PointObservation {
  Eigen::Vector3d p_w;      ///< [m]
  Eigen::Vector2d bearing;  ///< normalized image plane
};

/// Inlier threshold of camera localization by the window or the map.
inline constexpr double kLocalizationInlier_px = 5.0;

struct CameraPoseOptions {
  double inlier_threshold = 0.01;  ///< bearing error [normalized image plane]
  int iterations = 60;             ///< RANSAC hypotheses
  int min_inliers = 8;
  std::uint32_t seed = 1;
};

struct CameraPose {
  Pose T_w_c;
  int inliers = 0;
};

/// @param prediction predicted T_w_c, the initial guess of every hypothesis: should be accurate to about 20
/// degrees
/// @return nothing if no pose has `min_inliers` inliers
[[nodiscard]] std::optional<CameraPose> estimate_camera_pose(
    const std::vector<PointObservation>& observations, const Pose& prediction,
    const CameraPoseOptions& options);

/// Static points observed in the newest frame whose position is known from earlier frames.
/// @param recycled storage for the result; its content is ignored
[[nodiscard]] std::vector<PointObservation> known_points(const Window& window, const DepthConfig& depth,
                                                         std::vector<PointObservation> recycled);

/// Robust least squares from a prediction that is close to the solution, without RANSAC.
/// @param inlier_threshold scale of the Cauchy loss [normalized image plane]
[[nodiscard]] Pose refine_camera_pose(const std::vector<PointObservation>& observations,
                                      const Pose& prediction, double inlier_threshold);

}  // namespace stillpoint
