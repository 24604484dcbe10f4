// SPDX-License-Identifier: BSD-3-Clause
/// SO(3): exponential map, logarithm and right Jacobians. Perturbations are on the right: q <- q * Exp(d).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace stillpoint {

/// Cross-product matrix [v]_x: skew(a) * b == a x b.
[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Unit quaternion of the rotation vector `theta` [rad]: q = (cos(a / 2), sin(a / 2) theta / a), a = |theta|.
/// Accurate to machine precision near 0.
[[nodiscard]] Eigen::Quaterniond exp_so3(const Eigen::Vector3d& theta);

/// Rotation vector [rad] of the unit quaternion `q`, of length in [0, pi].
[[nodiscard]] Eigen::Vector3d log_so3(const Eigen::Quaterniond& q);

/// Right Jacobian: Exp(theta + d) ~ Exp(theta) * Exp(Jr(theta) * d). Forster et al. 2017, Eq. (8):
/// Jr = I - (1 - cos a) / a^2 [theta]_x + (a - sin a) / a^3 [theta]_x^2, a = |theta|.
[[nodiscard]] Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& theta);

/// Inverse of `right_jacobian`, |theta| < 2 pi: Log(Exp(theta) * Exp(d)) ~ theta + Jr^-1(theta) * d, where
/// Jr^-1 = I + [theta]_x / 2 + (1 - (a / 2) cot(a / 2)) / a^2 [theta]_x^2, a = |theta|.
[[nodiscard]] Eigen::Matrix3d right_jacobian_inverse(const Eigen::Vector3d& theta);

}  // namespace stillpoint
