// SPDX-License-Identifier: BSD-3-Clause
/// Closed-form motions and their ideal IMU samples.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "core/imu/preintegration.h"

namespace stillpoint {

inline const Eigen::Vector3d kGravity(0.0, 0.0, -9.81);

/// Samples of `imu_at(seconds)` from 0 to duration_s inclusive at `rate_hz`.
inline std::vector<ImuSample> sample_motion(double duration_s, double rate_hz,
                                            const std::function<ImuSample(double)>& imu_at) {
  std::vector<ImuSample> samples;
  const long steps = std::lround(duration_s * rate_hz);
  for (long i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / rate_hz;
    ImuSample sample = imu_at(t);
    sample.t = from_seconds(t);
    samples.push_back(sample);
  }
  return samples;
}

/// A body on a circle in the x-y plane, its x axis pointing outward.
struct Circle {
  double radius = 2.0;  ///< [m]
  double rate = 1.5;    ///< [rad/s]

  [[nodiscard]] NavState state(double t) const {
    const double angle = rate * t;
    NavState state;
    state.t = from_seconds(t);
    state.T_w_b.q = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ());
    state.T_w_b.p = radius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    state.v_w = radius * rate * Eigen::Vector3d(-std::sin(angle), std::cos(angle), 0.0);
    return state;
  }
  /// Centripetal acceleration r w^2 inward, and the reaction to gravity.
  [[nodiscard]] ImuSample imu() const {
    return {.t = {}, .gyro_b = {0.0, 0.0, rate}, .accel_b = {-radius * rate * rate, 0.0, 9.81}};
  }
};

/// Rotation about all axes with varying acceleration, so that no error terms cancel.
inline std::vector<ImuSample> rich_motion_samples(double duration_s, double rate_hz = 200.0) {
  return sample_motion(duration_s, rate_hz, [](double t) {
    return ImuSample{.t = {},
                     .gyro_b = {0.8 * std::sin(2.0 * t), -0.6 * std::cos(3.0 * t), 0.9 + 0.2 * std::sin(t)},
                     .accel_b = {1.5 * std::cos(4.0 * t), 9.0 + std::sin(t), 2.0 - 1.2 * std::sin(5.0 * t)}};
  });
}

}  // namespace stillpoint
