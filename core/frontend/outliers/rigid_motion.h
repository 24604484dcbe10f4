// SPDX-License-Identifier: BSD-3-Clause
/// Camera motion between two frames from points of known depth (3D-2D correspondences).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "core/geometry/pose.h"

namespace stillpoint {

struct PointCorrespondence {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< in the earlier camera frame [m]
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();  ///< in the later frame, normalized plane
};

struct RigidMotionSettings {
  double threshold = 0.002;  ///< largest reprojection error of an inlier [normalized plane]
  double confidence = 0.99;  ///< probability that at least one sample is free of outliers
};

/// T_to_from, the transform from the earlier to the later camera frame: RANSAC over samples of four
/// correspondences (p_i, b_i), then Gauss-Newton over all of them. Both minimize the reprojection error
///   sum_i rho(|r_i|), r_i = pi(T_to_from p_i) - b_i, pi(p) = (p.x, p.y) / p.z,
/// with the left perturbation p'_i <- Exp(theta) p'_i + t of p'_i = T_to_from p_i:
///   J_i = D_pi(p'_i) [-[p'_i]_x  I],  (sum_i w_i J_i^T J_i) (theta, t) = -sum_i w_i J_i^T r_i.
/// The refinement uses Cauchy weights w_i = 1 / (1 + |r_i|^2 / c^2) (Holland and Welsch 1977), c half the
/// inlier threshold, because a pose from four noisy points rejects good matches; samples use w_i ~ 1 and
/// start from the identity, as the motion between two frames is small. Deterministic; allocation-free.
/// @return nullopt for fewer than four correspondences, or if RANSAC finds no pose
[[nodiscard]] std::optional<Pose> estimate_rigid_motion(std::span<const PointCorrespondence> correspondences,
                                                        const RigidMotionSettings& settings);

}  // namespace stillpoint
