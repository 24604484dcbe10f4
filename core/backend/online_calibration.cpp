// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/online_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillpoint {
namespace {

constexpr double kRateHalfWidth_s = 0.02;  // as far as samples are available after the newest exposure

}  // namespace

void smooth_newest_rates(const ImuBuffer& imu, Window& window) {
  const std::size_t first = window.frames.size() - std::min<std::size_t>(window.frames.size(), 2);
  for (std::size_t i = first; i < window.frames.size(); ++i) {
    WindowFrame& frame = window.frames[i];
    const Timestamp exposure = after(frame.state.t, frame.time_offset_s);
    frame.gyro_b = imu.mean_rate(exposure, kRateHalfWidth_s).value_or(frame.gyro_b);
  }
}

void add_calibration_walk(const BackendConfig& config, Window& window) {
  if (window.newest() < 1) return;
  const NavState& before = window.frames[window.frames.size() - 2].state;
  const double root = std::sqrt(seconds_between(before.t, window.frames.back().state.t));
  const double time_offset = root * config.time_offset_walk;
  const double m = root * config.extrinsics_walk_m;
  const double rad = root * config.extrinsics_walk_rad;
  add_random_step(BlockKind::kTimeOffset, std::array{time_offset}, window.prior);
  add_random_step(BlockKind::kExtrinsics, std::array{m, m, m, rad, rad, rad}, window.prior);
}

bool bound_time_offset(const BackendConfig& config, double calibrated_s, Window& window) {
  const double max = config.time_offset_max_s;
  const double bounded = std::clamp(window.time_offset_s, calibrated_s - max, calibrated_s + max);
  const bool beyond = bounded != window.time_offset_s;
  window.time_offset_s = bounded;
  return beyond;
}

}  // namespace stillpoint
