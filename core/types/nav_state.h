// SPDX-License-Identifier: BSD-3-Clause
/// Navigation state: pose, velocity and IMU biases of the body.
#pragma once

#include <Eigen/Core>

#include "core/base/timestamp.h"
#include "core/geometry/pose.h"

namespace stillpoint {

struct NavState {
  Timestamp t;
  Pose T_w_b;
  Eigen::Vector3d v_w = Eigen::Vector3d::Zero();         ///< [m/s]
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

}  // namespace stillpoint
