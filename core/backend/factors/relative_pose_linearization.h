// SPDX-License-Identifier: BSD-3-Clause
/// Relative pose of a landmark's host camera and another camera, with its derivatives by the states.
#pragma once

#include "core/geometry/covariance.h"

namespace stillpoint {

/// T_cj_ci = T_c_b T_bj_w T_w_bi T_b_c. All observations of the same two frames share it, so their residuals
/// are linearized with respect to its left perturbation (nu, omega), dp = nu + omega x p for a point p in
/// camera j, and only their sum is mapped to the states.
struct RelativePoseLinearization {
  Eigen::Matrix3d R_cj_ci;
  Eigen::Vector3d p_cj_ci;
  Matrix6 J_pose_i;  ///< d(nu, omega) / d(p, theta) of T_w_bi, theta on the right
  Matrix6 J_pose_j;
  Matrix6 J_extrinsics;
};

/// What the relative poses of all frames have in common.
struct CameraOnBody {
  explicit CameraOnBody(const Pose& T_b_c);

  Eigen::Matrix3d R_b_c;
  Eigen::Vector3d p_b_c;
  Eigen::Vector3d p_c_b;
  Matrix6 J_pose_j;  ///< without the derivative by the position, which depends on frame j
};

/// What the relative poses of one frame and all others have in common.
struct CameraInWorld {
  CameraInWorld(const Pose& T_w_b, const CameraOnBody& camera);

  Eigen::Matrix3d R_w_b;
  Eigen::Vector3d p_w_b;
  Eigen::Matrix3d R_c_w;
};

/// Sets R_cj_ci and p_cj_ci.
void set_pose(const CameraInWorld& i, const CameraInWorld& j, const CameraOnBody& camera,
              RelativePoseLinearization& relative);

/// Sets the derivatives by the poses.
void set_pose_jacobians(const CameraInWorld& i, const CameraInWorld& j, const CameraOnBody& camera,
                        RelativePoseLinearization& relative);

/// Sets the derivative by T_b_c.
void set_extrinsics_jacobian(const CameraInWorld& i, const CameraInWorld& j, const CameraOnBody& camera,
                             RelativePoseLinearization& relative);

[[nodiscard]] RelativePoseLinearization linearize_relative_pose(const Pose& T_w_bi, const Pose& T_w_bj,
                                                                const Pose& T_b_c);

}  // namespace stillpoint
