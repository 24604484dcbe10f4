// SPDX-License-Identifier: BSD-3-Clause
/// Nonlinear least squares over the window: the state optimization of Paper Sec. II.
#pragma once

#include "core/backend/window/window.h"
#include "core/config/backend_config.h"

namespace stillpoint {

struct SolveReport {
  int iterations = 0;
  int landmarks = 0;        ///< used in the solve
  int depth_landmarks = 0;  ///< of those, with measured depth
  double initial_cost = 0.0;
  double final_cost = 0.0;
  bool usable = true;  ///< false: the solver failed and the window is unchanged
};

/// Minimizes over all states x of the window, with a limit on iterations but not on time (deterministic),
///
///   1/2 ( |r_prior(x)|^2 + |r_calibration(x)|^2 + sum_k |r_imu,k(x)|^2 + sum_l r_depth,l(x)^2
///         + sum_(l,j) rho(|r_visual,lj(x)|^2) ),    rho(s) = c^2 log(1 + s / c^2)   (Cauchy)
///
/// with the whitened residuals of LinearPrior, ImuFactor, HostDepthFactor and ReprojectionFactor, and
/// c = `cauchy_scale`. The window's prior fixes the gauge, so it must not be empty.
/// @param focal_px focal length of the camera, converts pixels to bearings
[[nodiscard]] SolveReport solve_window(Window& window, const BackendConfig& config, double focal_px);

class SchurSolver;

/// Same, with the buffers of `solver`; the result does not depend on earlier calls.
[[nodiscard]] SolveReport solve_window(Window& window, const BackendConfig& config, double focal_px,
                                       SchurSolver& solver);

}  // namespace stillpoint
