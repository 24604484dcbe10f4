// SPDX-License-Identifier: BSD-3-Clause
/// One step of the midpoint rule between two inertial samples, shared by all who integrate. Qin et al. 2018
/// (VINS-Mono), Sec. IV-B.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geometry/so3.h"
#include "core/types/imu_sample.h"

namespace stillpoint {

/// Biases to be taken off the samples: gyro [rad/s], accel [m/s^2].
struct ImuBias {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();
};

/// Rotation vector from one sample to the next at the mean of both rates [rad].
[[nodiscard]] inline Eigen::Vector3d midpoint_rotation(const ImuSample& from, const ImuSample& to,
                                                       const Eigen::Vector3d& gyro_bias) {
  const double dt = seconds_between(from.t, to.t);
  return (0.5 * (from.gyro_b + to.gyro_b) - gyro_bias) * dt;
}

/// What a step found, in the frame r in which the attitude is given.
struct MidpointStep {
  Eigen::Quaterniond q_r_b;  ///< attitude after the step
  Eigen::Vector3d force_r;   ///< mean of the specific forces at both ends [m/s^2]
  Eigen::Vector3d theta;     ///< rotation of the step, in the body [rad]
  Eigen::Vector3d force_to;  ///< specific force at the end, bias taken off, in the body there [m/s^2]
};

/// @param q_r_b attitude at `from`
[[nodiscard]] inline MidpointStep midpoint_step(const Eigen::Quaterniond& q_r_b, const ImuSample& from,
                                                const ImuSample& to, const ImuBias& bias) {
  MidpointStep step;
  step.theta = midpoint_rotation(from, to, bias.gyro);
  step.q_r_b = (q_r_b * exp_so3(step.theta)).normalized();
  step.force_to = to.accel_b - bias.accel;
  step.force_r = 0.5 * (q_r_b * (from.accel_b - bias.accel) + step.q_r_b * step.force_to);
  return step;
}

}  // namespace stillpoint
