// SPDX-License-Identifier: BSD-3-Clause
/// Gyro bias from rotations measured by another sensor. Qin et al. 2018 (VINS-Mono), Sec. V-B1.
#pragma once

#include <span>

#include "core/imu/preintegration.h"

namespace stillpoint {

/// An interval of inertial data and the rotation of the body over it from another source (vision, ground
/// truth).
struct RotationPair {
  const Preintegration* preintegration;  ///< not owned, never null
  Eigen::Quaterniond q_bi_bj;
};

/// Gyro bias [rad/s] by linear least squares over the rotation differences of all intervals,
///
///   min_b sum | Log(delta_q(b_0)^-1 q_bi_bj) - J (b - b_0) |^2,    J = d theta / d b_g,
///
/// with b_0 the linearization point of each preintegration. For biases of a few 0.01 rad/s iterate once:
/// repropagate with the result and estimate again.
///
/// @param pairs at least one, of positive duration
[[nodiscard]] Eigen::Vector3d estimate_gyro_bias(std::span<const RotationPair> pairs);

}  // namespace stillpoint
