// SPDX-License-Identifier: BSD-3-Clause
/// Configuration of IMU processing.
#pragma once

#include <type_traits>

namespace stillpoint {

struct ImuConfig {
  bool enabled = true;       ///< false: visual odometry, no inertial data used
  double gravity = 9.81;     ///< [m/s^2]
  double noise_scale = 1.0;  ///< factor on the noise densities: actual noise exceeds data sheet values
  // Noise densities of the sensor, see ImuNoise; 0 = those that the sequence states.
  double gyro_noise = 0.0;
  double accel_noise = 0.0;
  double gyro_walk = 0.0;
  double accel_walk = 0.0;
  double max_gap_s = 0.05;  ///< longer gaps between samples are counted; limit of extrapolation
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, ImuConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("enabled", config.enabled);
  field("gravity", config.gravity, 9.0, 10.0);
  field("noise_scale", config.noise_scale, 0.01, 1000.0);
  field("gyro_noise", config.gyro_noise, 0.0, 1.0);
  field("accel_noise", config.accel_noise, 0.0, 100.0);
  field("gyro_walk", config.gyro_walk, 0.0, 1.0);
  field("accel_walk", config.accel_walk, 0.0, 100.0);
  field("max_gap_s", config.max_gap_s, 0.001, 10.0);
}

}  // namespace stillpoint
