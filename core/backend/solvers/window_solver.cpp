// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/window_solver.h"

#include "core/backend/solvers/ceres_solver.h"
#include "core/backend/solvers/schur_solver.h"
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

std::unique_ptr<WindowSolver> make_window_solver(WindowSolverKind kind) {
  switch (kind) {
    case WindowSolverKind::kCeres:
      return std::make_unique<CeresSolver>();
    case WindowSolverKind::kSchur:
      return std::make_unique<SchurSolver>();
  }
  check_failed("a solver of this kind exists", __FILE__, __LINE__);
}

}  // namespace stillpoint
