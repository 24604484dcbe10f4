// SPDX-License-Identifier: BSD-3-Clause
/// Inertial data between two frames, with a noise that covers missing and wrong samples.
#pragma once

#include <array>
#include <span>

#include "core/imu/preintegration.h"
#include "core/types/odometry_update.h"

namespace stillpoint {

/// Noise densities of an interval without usable samples: over 33 ms standard deviations of 0.2 rad, 4 m/s
/// and 0.07 m, so that vision determines the motion. The random walk of the biases is that of the sensor.
[[nodiscard]] ImuNoise unreliable_noise(const ImuNoise& noise);

/// Recognizes defects that samples show by themselves.
class SampleInspector {
 public:
  /// Saturation: in four successive samples, one axis of a sensor has exactly the largest magnitude of the
  /// run, while another axis varies; or in 30 ms and eight samples exactly the same value.
  /// @param samples of the next interval, sorted by time; fewer than two are a gap
  /// @param has_gap see `ImuGap::is_long`
  /// @return kNone, kImuGap or kImuSaturated
  [[nodiscard]] StatusReason inspect(std::span<const ImuSample> samples, bool has_gap);

 private:
  /// Successive samples with the same value of one axis.
  struct Plateau {
    double value = 0.0;
    Timestamp begin;
    int samples = 0;
    bool others_vary = false;
  };
  [[nodiscard]] bool has_plateau(std::span<const ImuSample> samples);

  Eigen::Vector3d last_gyro_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d last_accel_ = Eigen::Vector3d::Zero();
  std::array<Plateau, 6> plateaus_;  ///< of the axes of gyroscope and accelerometer
  double largest_gyro_ = 0.0;        ///< magnitude of a component [rad/s]
  double largest_accel_ = 0.0;       ///< same [m/s^2]
};

/// Samples of a motion with constant velocity, in place of missing ones.
/// @param before state at `begin`; gravity_w [m/s^2]
[[nodiscard]] std::vector<ImuSample> constant_velocity_samples(const NavState& before,
                                                               const Eigen::Vector3d& gravity_w,
                                                               Timestamp begin, Timestamp end);

}  // namespace stillpoint
