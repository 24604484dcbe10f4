// SPDX-License-Identifier: BSD-3-Clause
/// Monocular structure from motion over the window. Qin et al. 2018 (VINS-Mono), Sec. V-A.
#pragma once

#include <optional>

#include "core/backend/solvers/window_solver.h"

namespace stillpoint {

/// Estimates all camera poses and the landmarks with sufficient parallax, up to scale (median depth about 1).
///
/// 1. Reference: the first frame with enough common features and parallax with the newest frame; relative
///    pose by the five-point algorithm; triangulation of the common features.
/// 2. The frames in between, then the older ones, are localized by PnP; new points are triangulated on the
///    way.
/// 3. Bundle adjustment.
///
/// Gyroscope data are used only to compensate rotation in the parallax and to predict rotations for PnP.
/// @param window every frame but the first with inertial samples; its poses and depths are not used
/// @param focal_px focal length of the camera, converts pixels to bearings
/// @param solver for the bundle adjustment
/// @return the window in the frame of the reference camera; nothing if the parallax is insufficient or a step
/// fails
[[nodiscard]] std::optional<Window> reconstruct_window(const Window& window, const BackendConfig& config,
                                                       double focal_px, WindowSolver& solver);

}  // namespace stillpoint
