// SPDX-License-Identifier: BSD-3-Clause
/// Gyro bias from rotations that another sensor saw. Qin et al. 2018 (VINS-Mono), Sec. V-B1.
#pragma once

#include <span>

#include "core/imu/preintegration.h"

namespace stillpoint {

/// An interval of inertial data and the rotation of the body over it from elsewhere (vision, ground truth).
struct RotationPair {
  const Preintegration* preintegration;  ///< not owned, never null
  Eigen::Quaterniond q_bi_bj;
};

/// The gyro bias [rad/s] that lets all intervals agree best: least squares over the rotation differences,
/// first order around each interval's own linearisation point. The biases of a few 0.01 rad/s of real sensors
/// want a second round: repropagate with the result, and ask again.
///
/// @param pairs at least one, of positive duration
[[nodiscard]] Eigen::Vector3d estimate_gyro_bias(std::span<const RotationPair> pairs);

}  // namespace stillpoint
