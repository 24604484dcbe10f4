// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/gauge.h"

#include "core/backend/start/initializer.h"

namespace stillpoint {
namespace {

constexpr double kJump_m = 0.1;
constexpr double kJump_rad = 0.02;

}  // namespace

bool restore_gauge(const Pose& oldest_T_w_b, const InitializerConfig& config, Window& window) {
  const Pose& current = window.frames.front().state.T_w_b;
  const bool translated = (current.p - oldest_T_w_b.p).norm() > kJump_m;
  const bool rotated = current.q.angularDistance(oldest_T_w_b.q) > kJump_rad;
  if (!translated && !rotated) return false;
  const Pose correction = oldest_T_w_b * current.inverse();
  for (WindowFrame& frame : window.frames) frame.state.T_w_b = correction * frame.state.T_w_b;
  window.prior = initial_prior(window, config);
  return true;
}

}  // namespace stillpoint
