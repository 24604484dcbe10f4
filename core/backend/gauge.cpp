// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/gauge.h"

#include "core/backend/initializer.h"

namespace stillpoint {
namespace {

constexpr double kJump_m = 0.1;
constexpr double kJump_rad = 0.02;

}  // namespace

bool undo_jump(const Pose& oldest_T_w_b, const InitializerConfig& config, Window& window) {
  const Pose& now = window.frames.front().state.T_w_b;
  const bool moved = (now.p - oldest_T_w_b.p).norm() > kJump_m;
  const bool turned = now.q.angularDistance(oldest_T_w_b.q) > kJump_rad;
  if (!moved && !turned) return false;
  const Pose back = oldest_T_w_b * now.inverse();
  for (WindowFrame& frame : window.frames) frame.state.T_w_b = back * frame.state.T_w_b;
  window.prior = first_prior(window, config);
  return true;
}

}  // namespace stillpoint
