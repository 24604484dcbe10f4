// SPDX-License-Identifier: BSD-3-Clause
/// State optimization by Ceres: the reference implementation of WindowSolver.
#pragma once

#include "core/backend/solvers/window_solver.h"

namespace stillpoint {

/// Dense Schur complement over the landmarks, Powell's dogleg, one thread.
class CeresSolver final : public WindowSolver {
 public:
  /// Forms the dense H of all states. The square root of H* = V D V^T is J = D^1/2 V^T, r0 = D^-1/2 V^T b*,
  /// without the eigenvalues that are numerically zero; H_mm^-1 is the corresponding pseudo-inverse.
  [[nodiscard]] LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config,
                                               double focal_px, LinearPrior recycled) override;

  /// By the inverse of the dense H of all states.
  [[nodiscard]] std::optional<WindowCovariance> covariance(const Window& window, const BackendConfig& config,
                                                           double focal_px, bool oldest_motion) override;

 private:
  [[nodiscard]] SolveReport minimize(Window& window, const BackendConfig& config, double focal_px) override;
};

}  // namespace stillpoint
