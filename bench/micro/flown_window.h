// SPDX-License-Identifier: BSD-3-Clause
/// A full inertial window as the estimator has it in flight, for benchmarks of the backend.
#pragma once

#include "tests/support/simulated_flight.h"
#include "tests/support/take_in.h"

namespace stillpoint {

constexpr double kFlownFocal_px = 500.0;

/// Settings of the benchmarks: every depth is a residual, eight iterations whatever the cost.
inline BackendConfig flown_config() {
  BackendConfig config;
  config.rate_hz = 0.0;
  config.depth.usage = DepthUsage::kWeighted;
  config.initializer.kind = InitializerKind::kInstant;
  config.function_tolerance = 1e-12;
  return config;
}

/// Eleven states at 10 Hz with about 150 landmarks, noise as of a good camera; the newest state is only
/// predicted.
inline Window flown_window() {
  const SimulatedFlight flight{.pixel_noise_px = 0.3, .depth_noise = 0.003, .noisy_imu = true};
  Estimator estimator(flown_config(), ImuConfig{}, SimulatedFlight::rig(), 1);
  for (const ImuSample& sample : flight.imu(3.0)) estimator.add_imu(sample);
  for (int i = 0; i < 20; ++i) static_cast<void>(take_in(estimator, flight.picture(i, 0.1 + 0.1 * i)));
  Window window = estimator.window();
  window.frames.back().state.T_w_b.p += Eigen::Vector3d(0.01, -0.005, 0.01);
  return window;
}

}  // namespace stillpoint
