// SPDX-License-Identifier: BSD-3-Clause
/// Uncertainty to first order: size of a covariance, test of a squared Mahalanobis distance, and poses with
/// the covariance of their errors (Barfoot and Furgale 2014, Sec. III): change of the frame, composition,
/// distance, fusion.
#pragma once

#include <Eigen/Core>

#include "core/geometry/pose.h"

namespace stillpoint {

/// Standard deviation along the least certain direction: the square root of the largest eigenvalue, or 0 if
/// rounding made that negative.
/// @param covariance symmetric; its lower triangle is used. The result has the unit of its square root.
[[nodiscard]] double largest_sigma(const Eigen::Matrix3d& covariance);

/// Tail P(X > x) of the chi-square distribution, for decisions by a squared Mahalanobis distance. With Q(a,
/// z) the regularized incomplete gamma function, this is Q(n / 2, x / 2), by the recurrence
///
///   Q(1/2, z) = erfc(sqrt(z)),    Q(1, z) = exp(-z),    Q(a + 1, z) = Q(a, z) + z^a exp(-z) / Gamma(a + 1)
///
/// (Abramowitz and Stegun 1964, 6.5.21 and 26.4.4).
/// @param x >= 0
/// @param degrees_of_freedom n >= 1
[[nodiscard]] double chi_square_tail(double x, int degrees_of_freedom);

/// The true pose is (p + dp, q Exp(dtheta)): dp in the frame w, dtheta in the frame f. The frame w may be
/// another body, of a relative pose.
struct UncertainPose {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  Pose T_w_f;
  Matrix6 covariance = Matrix6::Zero();  ///< of (dp, dtheta)
};

using Matrix6 = UncertainPose::Matrix6;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

/// Pose of another frame on the same rigid body: T_w_g = T_w_f T_f_g. With the rotations of these,
///
///   dp_g = dp_f - R_w_f [p_f_g]x dtheta_f,    dtheta_g = R_g_f dtheta_f.
[[nodiscard]] UncertainPose in_frame(const UncertainPose& pose, const Pose& T_f_g);

/// Composition of independent poses:
///
///   dp = dp_a - R_a [p_b]x dtheta_a + R_a dp_b,   dtheta = R_b^T dtheta_a + dtheta_b
[[nodiscard]] UncertainPose compose(const UncertainPose& a, const UncertainPose& b);

/// The inverse: dp' = -R^T dp - [R^T p]x dtheta, dtheta' = -R dtheta.
[[nodiscard]] UncertainPose inverse(const UncertainPose& a);

/// T_a_b of two poses with common errors. With p_a_b = R_a^T (p_b - p_a):
///
///   dp = R_a^T (dp_b - dp_a) + [p_a_b]x dtheta_a,   dtheta = dtheta_b - R_b^T R_a dtheta_a
///
/// @param T_w_a pose that becomes the origin
/// @param T_w_b pose to be expressed in a
/// @param joint covariance of (dp_a, dtheta_a, dp_b, dtheta_b)
[[nodiscard]] UncertainPose relative_pose(const Pose& T_w_a, const Pose& T_w_b, const Matrix12& joint);

/// Covariance J P J^T of the projection (x / z, y / z) of a fixed point by an uncertain camera. With the
/// position p_c of the point in the camera frame c,
///
///   dp_c = -R_c_w dp + [p_c]x dtheta,    d(x / z, y / z) = (1 / z) [ 1 0 -x/z ; 0 1 -y/z ] dp_c.
///
/// @param camera T_w_c
/// @param p_c in front of the camera [m]
[[nodiscard]] Eigen::Matrix2d projection_covariance(const UncertainPose& camera, const Eigen::Vector3d& p_c);

/// Squared Mahalanobis distance d^T P^-1 d of two poses, with d = (p_b - p_a, Log(q_a^-1 q_b)).
/// @param a pose with which d begins
/// @param b pose with which d ends
/// @param covariance P of d, positive definite
[[nodiscard]] double squared_distance(const Pose& a, const Pose& b, const UncertainPose::Matrix6& covariance);

/// Least-squares combination of two independent estimates of one pose (update of a Kalman filter), to first
/// order in their difference d. With the covariances P_a, P_b and K = P_a (P_a + P_b)^-1:
///
///   pose = a (+) K d,    covariance = P_a - K P_a.
[[nodiscard]] UncertainPose fuse(const UncertainPose& a, const UncertainPose& b);

}  // namespace stillpoint
