// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/window_solver.h"

#include "core/base/error.h"

namespace stillpoint {
namespace {

/// Resets landmarks at infinity or behind their host, so that their depth is initialized again.
void invalidate_lost_depths(const DepthConfig& config, Window& window) {
  for (Landmark& landmark : window.landmarks) {
    if (landmark.inverse_depth * config.max_landmark_depth_m < 1.0) landmark.inverse_depth = 0.0;
  }
}

}  // namespace

SolveReport WindowSolver::solve(Window& window, const BackendConfig& config, double focal_px) {
  STILLPOINT_CHECK(!window.prior.empty());
  const SolveReport report = minimize(window, config, focal_px);
  if (report.usable) invalidate_lost_depths(config.depth, window);
  return report;
}

}  // namespace stillpoint
