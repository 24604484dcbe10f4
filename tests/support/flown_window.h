// SPDX-License-Identifier: BSD-3-Clause
/// A full window as the estimator has it in flight, for tests and benchmarks of the backend.
#pragma once

#include "tests/support/simulated_flight.h"
#include "tests/support/take_in.h"

namespace stillpoint {

constexpr double kFlownFocal_px = 500.0;

/// Every depth is a residual, eight iterations whatever the cost.
inline BackendConfig flown_config() {
  BackendConfig config;
  config.rate_hz = 0.0;
  config.depth.usage = DepthUsage::kWeighted;
  config.initializer.kind = InitializerKind::kInstant;
  config.function_tolerance = 1e-12;
  return config;
}

struct FlownOptions {
  BackendConfig config = flown_config();
  bool inertial = true;
  int pictures = 20;  ///< at 10 Hz
  int points = 300;   ///< about half of them become landmarks
};

/// A window at the end of a flight, noise as of a good camera; the newest state is only predicted.
inline Window flown_window(const FlownOptions& options = {}) {
  const SimulatedFlight flight{
      .pixel_noise_px = 0.3, .depth_noise = 0.003, .noisy_imu = true, .points = options.points};
  ImuConfig imu;
  imu.enabled = options.inertial;
  Estimator estimator(options.config, imu, SimulatedFlight::rig(), 1);
  for (const ImuSample& sample : flight.imu(0.1 * options.pictures + 1.0)) estimator.add_imu(sample);
  for (int i = 0; i < options.pictures; ++i) {
    static_cast<void>(take_in(estimator, flight.picture(i, 0.1 + 0.1 * i)));
  }
  Window window = estimator.window();
  window.frames.back().state.T_w_b.p += Eigen::Vector3d(0.01, -0.005, 0.01);
  return window;
}

}  // namespace stillpoint
