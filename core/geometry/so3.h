// SPDX-License-Identifier: BSD-3-Clause
/// Rotations: exponential map, logarithm and the Jacobians of SO(3). Right perturbation, q <- q * Exp(theta).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace stillpoint {

/// Matrix of the cross product: skew(a) * b == a x b.
[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Unit quaternion of the rotation vector `theta` [rad]; exact to machine precision at 0.
[[nodiscard]] Eigen::Quaterniond exp_so3(const Eigen::Vector3d& theta);

/// Rotation vector [rad] of the unit quaternion `q`, of length in [0, pi].
[[nodiscard]] Eigen::Vector3d log_so3(const Eigen::Quaterniond& q);

/// Right Jacobian: Exp(theta + d) ~ Exp(theta) * Exp(right_jacobian(theta) * d). Forster et al. 2017, Eq.
/// (8).
[[nodiscard]] Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& theta);

/// Inverse of `right_jacobian`: Log(Exp(theta) * Exp(d)) ~ theta + right_jacobian_inverse(theta) * d. |theta|
/// < 2 pi.
[[nodiscard]] Eigen::Matrix3d right_jacobian_inverse(const Eigen::Vector3d& theta);

}  // namespace stillpoint
