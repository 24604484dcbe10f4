// SPDX-License-Identifier: BSD-3-Clause
/// The published system, for tests of its rules and for scenarios whose limits were set with it.
#pragma once

#include "bench/config/config_file.h"

namespace stillpoint {

/// Dynamic-VINS with the limits and priors that it lacks: the short motions of tests need them.
inline OdometryConfig published_config() {
  const OdometryConfig defaults;
  OdometryConfig config = bench::load_config({.base = "dynamic_vins", .variant = "", .settings = {}});
  config.frontend.ransac_min_inlier_ratio = defaults.frontend.ransac_min_inlier_ratio;
  config.frontend.depth_max_spread = defaults.frontend.depth_max_spread;
  config.dynamic.max_skipped_frames = defaults.dynamic.max_skipped_frames;
  config.backend.keyframe_min_shared_ratio = defaults.backend.keyframe_min_shared_ratio;
  config.backend.keyframe_max_interval_s = 5.0;
  config.backend.time_offset_sigma_s = defaults.backend.time_offset_sigma_s;
  config.backend.depth.max_m = defaults.backend.depth.max_m;
  config.backend.depth.max_landmark_depth_m = defaults.backend.depth.max_landmark_depth_m;
  config.backend.initializer.gyro_bias_sigma = defaults.backend.initializer.gyro_bias_sigma;
  config.backend.initializer.accel_bias_sigma = defaults.backend.initializer.accel_bias_sigma;
  return config;
}

}  // namespace stillpoint
