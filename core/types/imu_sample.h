// SPDX-License-Identifier: BSD-3-Clause
/// IMU sample and IMU noise parameters.
#pragma once

#include <Eigen/Core>

#include "core/base/timestamp.h"

namespace stillpoint {

/// Angular rate [rad/s] and specific force [m/s^2] in the body frame, biases included.
struct ImuSample {
  Timestamp t;
  Eigen::Vector3d gyro_b = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_b = Eigen::Vector3d::Zero();
};

/// Continuous-time noise densities, as given by a data sheet or an Allan deviation plot.
struct ImuNoise {
  double gyro_noise = 1.6e-3;   ///< [rad/s/sqrt(Hz)]
  double accel_noise = 1.6e-2;  ///< [m/s^2/sqrt(Hz)]
  double gyro_walk = 2e-5;      ///< [rad/s^2/sqrt(Hz)]
  double accel_walk = 2e-4;     ///< [m/s^3/sqrt(Hz)]
};

}  // namespace stillpoint
