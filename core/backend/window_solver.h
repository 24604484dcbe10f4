// SPDX-License-Identifier: BSD-3-Clause
/// Refines the whole window by nonlinear least squares: the state optimisation of Paper Sec. II.
#pragma once

#include "core/backend/backend_config.h"
#include "core/backend/window.h"

namespace stillpoint {

struct SolveReport {
  int iterations = 0;
  int landmarks = 0;        ///< that took part
  int depth_landmarks = 0;  ///< of those, with measured depth
  double initial_cost = 0.0;
  double final_cost = 0.0;
  bool usable = true;  ///< false: the solver failed and the window is as it was
};

/// Moves the window's states to the minimum of all residuals, by a fixed number of iterations at most: no
/// clock decides. The window's prior holds the gauge, so it must not be empty.
/// @param focal_px the camera's focal length, by which pixels become bearings
[[nodiscard]] SolveReport solve_window(Window& window, const BackendConfig& config, double focal_px);

class SchurSolver;

/// The same in memory kept from the last solve; the result does not depend on it.
[[nodiscard]] SolveReport solve_window(Window& window, const BackendConfig& config, double focal_px,
                                       SchurSolver& solver);

}  // namespace stillpoint
