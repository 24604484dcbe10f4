// SPDX-License-Identifier: BSD-3-Clause
/// A full estimator window on a simulated trajectory, for tests and benchmarks of the backend.
#pragma once

#include "core/backend/estimator.h"
#include "tests/support/published_config.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {

constexpr double kSimulatedFocal_px = 500.0;

/// Depths are residuals; always eight iterations (the cost tolerance never stops the solve).
inline BackendConfig simulated_window_config() {
  BackendConfig config = published_config().backend;
  config.rate_hz = 0.0;
  config.depth.usage = DepthUsage::kWeighted;
  config.initializer.kind = InitializerKind::kInstant;
  config.function_tolerance = 1e-12;
  return config;
}

struct SimulatedWindowOptions {
  BackendConfig config = simulated_window_config();
  bool inertial = true;
  int frames = 20;   ///< at 10 Hz
  int points = 300;  ///< about half of them become landmarks
  double time_offset_s = 0.0;
  double depth_factor = 1.0;  ///< ratio of measured to true depth
};

/// The window after a simulated motion with the noise of a good camera; the newest state is perturbed.
inline Window simulated_window(const SimulatedWindowOptions& options = {}) {
  const SimulatedMotion motion{.pixel_noise_px = 0.3,
                               .depth_noise = 0.003,
                               .depth_factor = options.depth_factor,
                               .noisy_imu = true,
                               .time_offset_s = options.time_offset_s,
                               .points = options.points};
  ImuConfig imu = published_config().imu;
  imu.enabled = options.inertial;
  Estimator estimator(options.config, imu, SimulatedMotion::rig(), 1);
  for (const ImuSample& sample : motion.imu(0.1 * options.frames + 1.0)) estimator.add_imu(sample);
  for (int i = 0; i < options.frames; ++i) {
    estimator.process(motion.frame(i, 0.1 + 0.1 * i));
  }
  Window window = estimator.window();
  window.frames.back().state.T_w_b.p += Eigen::Vector3d(0.01, -0.005, 0.01);
  return window;
}

}  // namespace stillpoint
