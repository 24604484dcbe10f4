// SPDX-License-Identifier: BSD-3-Clause
/// A smooth path through jittery motion-capture poses that agrees with the IMU which flew along.
///
/// Motion capture is right about where the body is but noisy from sample to sample, and has gaps; the IMU is
/// right about fast motion but drifts. A spline is fitted to both by linear least squares: to the poses, to
/// the angular rates (dq/dt = q * (w - b) / 2 is linear in q) and to the accelerations (p'' = R (a - b) + g
/// is linear in p). Continuous-time fusion after Furgale, Barfoot and Sibley (2012).
#pragma once

#include <span>

#include "core/base/timestamp.h"
#include "core/types/imu_sample.h"
#include "core/types/trajectory.h"
#include "datasets/synthetic/path_spline.h"

namespace stillpoint {

/// How much each source is trusted, per sample.
struct SmootherConfig {
  double knot_interval_s = 0.01;
  double position_sigma_m = 0.002;
  double rotation_sigma = 0.01;  ///< [rad]
  double gyro_sigma = 0.01;      ///< with the vibration of a drone [rad/s]
  double accel_sigma = 0.15;     ///< same [m/s^2]
  int iterations = 10;           ///< of: fit, then estimate the biases
};

struct SmoothedFlight {
  PathSpline path;  ///< time 0 = the epoch
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  // Root mean squares of one vector's length, bias taken off.
  double position_residual_m = 0.0;
  double rotation_residual = 0.0;  ///< [rad]
  double gyro_residual = 0.0;      ///< [rad/s]
  double accel_residual = 0.0;     ///< [m/s^2]
};

/// @param poses T_w_b of the IMU, within [from_s, to_s] of the epoch, a little more at both ends is better
/// @param imu   readings over the same span
[[nodiscard]] SmoothedFlight smooth_flight(std::span<const StampedPose> poses, std::span<const ImuSample> imu,
                                           Timestamp epoch, double from_s, double to_s,
                                           const SmootherConfig& config = {});

}  // namespace stillpoint
