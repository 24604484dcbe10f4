// SPDX-License-Identifier: BSD-3-Clause
/// Priors of a window that starts: gauge, biases and calibration.
#pragma once

#include "core/backend/window/window.h"
#include "core/config/backend_config.h"

namespace stillpoint {

/// Initial prior of a window: fixes the gauge at frame 0 and constrains its biases by their configured
/// uncertainty. The gauge is the whole pose; with an IMU and constant gravity only position and heading. If
/// gravity is estimated, it is constrained by `Window::gravity_covariance`. With the consistent prior and
/// estimated extrinsics the pose of the camera is fixed, not that of the body: else each change of the
/// extrinsics would rotate the trajectory of the camera, which vision determines without them.
[[nodiscard]] LinearPrior initial_prior(const Window& window, const BackendConfig& config);

/// Prior on extrinsics, time offset and, if estimated, depth scale at their current values, with the
/// configured uncertainty.
[[nodiscard]] LinearPrior calibration_prior(const Window& window, const BackendConfig& config);

/// calibration_prior with the covariance of a RotationAlignment for rotation and time offset.
[[nodiscard]] LinearPrior aligned_calibration_prior(const Window& window, const BackendConfig& config,
                                                    const Eigen::Matrix4d& rotation_and_offset);

/// Restores the gauge after a jump of the whole window. Without inertial data only the marginalization prior
/// constrains the pose of the oldest frame in the world. If a solve moves it by more than 0.1 m or 0.02 rad,
/// the prior is inconsistent, that is, it was linearized from a moving landmark. All poses are then
/// transformed rigidly such that the oldest one is back at `oldest_T_w_b`, and the prior is reset to the
/// initial one.
/// @param oldest_T_w_b pose of the oldest frame before the solve
/// @return whether there was a jump
bool restore_gauge(const Pose& oldest_T_w_b, const BackendConfig& config, Window& window);

}  // namespace stillpoint
