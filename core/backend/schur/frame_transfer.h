// SPDX-License-Identifier: BSD-3-Clause
/// The pose of a landmark's host as another frame's camera sees it, and how it follows the states.
#pragma once

#include "core/geometry/pose.h"

namespace stillpoint {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// All sightings between the same two frames share one transform, so their residuals are linearised by its
/// six tangent directions, and only their sum is brought to the states. The tangent (nu, omega) is on the
/// left: a point seen at p moves by nu + omega x p.
struct FrameTransfer {
  Eigen::Matrix3d R_cj_ci;
  Eigen::Vector3d p_cj_ci;
  Matrix6 by_pose_i;  ///< (nu, omega) by the tangent of T_w_bi: (p, theta on the right)
  Matrix6 by_pose_j;
  Matrix6 by_extrinsics;
};

[[nodiscard]] FrameTransfer frame_transfer(const Pose& T_w_bi, const Pose& T_w_bj, const Pose& T_b_c);

}  // namespace stillpoint
