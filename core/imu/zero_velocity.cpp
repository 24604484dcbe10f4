// SPDX-License-Identifier: BSD-3-Clause
#include "core/imu/zero_velocity.h"

#include <limits>

namespace stillpoint {

double zero_velocity_statistic(std::span<const ImuSample> samples, const NavState& state,
                               const ImuNoise& noise, double gravity) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (samples.size() < 2 || noise.accel_noise <= 0.0 || noise.gyro_noise <= 0.0) return kNever;
  const double interval_s =
      seconds_between(samples.front().t, samples.back().t) / static_cast<double>(samples.size() - 1);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : samples) mean += sample.accel_b - state.accel_bias;
  const Eigen::Vector3d gravity_b = gravity * mean.normalized();
  double accel_squared = 0.0;
  double gyro_squared = 0.0;
  for (const ImuSample& sample : samples) {
    accel_squared += (sample.accel_b - state.accel_bias - gravity_b).squaredNorm();
    gyro_squared += (sample.gyro_b - state.gyro_bias).squaredNorm();
  }
  const double sum = accel_squared / (noise.accel_noise * noise.accel_noise) +
                     gyro_squared / (noise.gyro_noise * noise.gyro_noise);
  return sum * interval_s / static_cast<double>(samples.size());
}

}  // namespace stillpoint
