// SPDX-License-Identifier: BSD-3-Clause
/// Fast visual odometry configuration for tests of runners.
#pragma once

#include "tests/support/published_config.h"

namespace stillpoint {

inline OdometryConfig visual_config(int feedback_lag = 0) {
  OdometryConfig config = published_config();
  config.imu.enabled = false;
  config.frontend.min_distance_px = 10;
  config.frontend.unstable_radius_px = 10;
  config.backend.rate_hz = 0.0;
  config.backend.max_iterations = 2;
  config.pipeline.feedback_lag = feedback_lag;
  return config;
}

}  // namespace stillpoint
