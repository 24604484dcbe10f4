// SPDX-License-Identifier: BSD-3-Clause
/// Poses with the covariance of their errors: change of the frame, distance, and fusion.
#pragma once

#include "core/geometry/pose.h"

namespace stillpoint {

/// The true pose is (p + dp, q Exp(dtheta)): dp in the world frame, dtheta in the frame f.
struct UncertainPose {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  Pose T_w_f;
  Matrix6 covariance = Matrix6::Zero();  ///< of (dp, dtheta)
};

/// Pose of another frame on the same rigid body: T_w_g = T_w_f T_f_g. With the rotations of these,
///
///   dp_g = dp_f - R_w_f [p_f_g]x dtheta_f,    dtheta_g = R_g_f dtheta_f.
[[nodiscard]] UncertainPose in_frame(const UncertainPose& pose, const Pose& T_f_g);

/// Squared Mahalanobis distance d^T P^-1 d of two poses, with d = (p_b - p_a, Log(q_a^-1 q_b)).
/// @param covariance P of d, positive definite
[[nodiscard]] double squared_distance(const Pose& a, const Pose& b, const UncertainPose::Matrix6& covariance);

/// Least-squares combination of two independent estimates of one pose (update of a Kalman filter), to first
/// order in their difference d. With the covariances P_a, P_b and K = P_a (P_a + P_b)^-1:
///
///   pose = a (+) K d,    covariance = P_a - K P_a.
[[nodiscard]] UncertainPose fuse(const UncertainPose& a, const UncertainPose& b);

}  // namespace stillpoint
