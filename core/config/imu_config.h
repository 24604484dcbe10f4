// SPDX-License-Identifier: BSD-3-Clause
/// Configuration of IMU processing.
#pragma once

#include <type_traits>

namespace stillpoint {

struct ImuConfig {
  bool enabled = true;       ///< false: visual odometry, no inertial data used
  double gravity = 9.81;     ///< [m/s^2]
  double noise_scale = 1.0;  ///< factor on the rig's noise densities: actual noise exceeds data sheet values
  double max_gap_s = 0.05;   ///< longer gaps between samples are counted; limit of extrapolation
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, ImuConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("enabled", config.enabled);
  field("gravity", config.gravity, 9.0, 10.0);
  field("noise_scale", config.noise_scale, 0.01, 1000.0);
  field("max_gap_s", config.max_gap_s, 0.001, 10.0);
}

}  // namespace stillpoint
