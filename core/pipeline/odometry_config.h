// SPDX-License-Identifier: BSD-3-Clause
/// Every setting of the odometry in one struct. The defaults are Dynamic-VINS; files and overlays change
/// them.
#pragma once

#include <type_traits>

#include "core/backend/backend_config.h"
#include "core/frontend/frontend_config.h"

namespace stillpoint {

struct ImuConfig {
  bool enabled = true;       ///< false: visual odometry, no inertial data used
  double gravity = 9.81;     ///< [m/s^2]
  double noise_scale = 1.0;  ///< factor on the rig's noise densities: real sensors exceed their data sheets
  double max_gap_s = 0.05;   ///< longer holes between samples are counted
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, ImuConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("enabled", config.enabled);
  field("gravity", config.gravity, 9.0, 10.0);
  field("noise_scale", config.noise_scale, 0.01, 1000.0);
  field("max_gap_s", config.max_gap_s, 0.001, 10.0);
}

struct OdometryConfig {
  int seed = 1;  ///< of everything random in a run
  ImuConfig imu;
  FrontendConfig frontend;
  BackendConfig backend;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, OdometryConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("seed", config.seed, 0, 1000000000);
  field("imu", config.imu);
  field("frontend", config.frontend);
  field("backend", config.backend);
}

}  // namespace stillpoint
