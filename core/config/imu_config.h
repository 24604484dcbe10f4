// SPDX-License-Identifier: BSD-3-Clause
/// Configuration of IMU processing. The defaults are those of the program, see odometry_config.h. The field
/// list explains each key.
#pragma once

#include <type_traits>

#include "core/base/fields.h"

namespace stillpoint {

struct ImuConfig {
  bool enabled = true;
  double gravity = 9.81;
  double noise_scale = 1.0;
  bool adapt_noise = true;  ///< a moving sensor is noisier than its data sheet; else worse than vision alone
  double gyro_noise = 0.0;
  double accel_noise = 0.0;
  double gyro_walk = 0.0;
  double accel_walk = 0.0;
  /// Longer gaps between samples are counted; limit of extrapolation. Not a key: two and a half of the 20 ms
  /// look-ahead of the stages, and ten samples of the slowest sensor among the supported datasets (200 Hz).
  double max_gap_s = 0.05;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, ImuConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("enabled", config.enabled,
        FieldInfo{.text = "Whether inertial data is used; without it the system is visual odometry.",
                  .paper = "IV-B"});
  field("gravity", config.gravity, FieldInfo{"Norm of gravity.", "m/s^2", 9.0, 10.0});
  field("noise_scale", config.noise_scale,
        FieldInfo{"Factor on all noise densities: the noise of a moving sensor exceeds its data sheet.", "",
                  0.01, 1000.0});
  field("adapt_noise", config.adapt_noise,
        FieldInfo{.text = "Whether the noise of gyroscope and accelerometer is estimated while running, from "
                          "the stated densities upwards."});
  field("gyro_noise", config.gyro_noise,
        FieldInfo{"Density of the white noise of the gyroscope; 0 = that of the sequence or rig.toml.",
                  "rad/s/sqrt(Hz)", 0.0, 1.0});
  field("accel_noise", config.accel_noise,
        FieldInfo{"Density of the white noise of the accelerometer; 0 = that of the sequence or rig.toml.",
                  "m/s^2/sqrt(Hz)", 0.0, 100.0});
  field("gyro_walk", config.gyro_walk,
        FieldInfo{"Density of the random walk of the gyroscope bias; 0 = that of the sequence or rig.toml.",
                  "rad/s^2/sqrt(Hz)", 0.0, 1.0});
  field(
      "accel_walk", config.accel_walk,
      FieldInfo{"Density of the random walk of the accelerometer bias; 0 = that of the sequence or rig.toml.",
                "m/s^3/sqrt(Hz)", 0.0, 100.0});
}

}  // namespace stillpoint
