// SPDX-License-Identifier: BSD-3-Clause
/// White noise and bias of inertial sensors where they rest.
///
/// In windows of 1 s the Allan variance (Allan 1966) of means x_k over clusters of tau = 0.05 s gives the
/// white noise density n of an axis,
///   n^2 = tau mean_k (x_k+1 - x_k)^2 / 2,
/// which does not depend on tau for white noise, increases with it in motion, and decreases with it in
/// vibration. A window rests if n^2 of tau and that of single samples differ by a factor of at most four, and
/// at 0.25 s it is at most four times that of tau, for both sensors. Only windows with at most four times the
/// variance of the quietest one count: a running motor vibrates. The random walk of biases is not told: it
/// takes minutes of rest to exceed the white noise.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "core/types/rig.h"

namespace stillpoint {

struct RestingNoise {
  double seconds = 0.0;         ///< of the windows that rest
  double gyro_noise = 0.0;      ///< [rad/s/sqrt(Hz)], root mean square of the axes
  double accel_noise = 0.0;     ///< [m/s^2/sqrt(Hz)]
  double relative_sigma = 0.0;  ///< standard deviation of both densities, relative to them
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  ///< [rad/s], the rotation of the earth included
  double gyro_bias_sigma = 0.0;                         ///< per axis, of the white noise over the seconds
};

/// @param samples ascending; gaps of more than 0.02 s end a window
/// @return nullopt if the sensors do not rest for a second
[[nodiscard]] std::optional<RestingNoise> resting_noise(std::span<const ImuSample> samples);

}  // namespace stillpoint
