// SPDX-License-Identifier: BSD-3-Clause
/// Online calibration: time offset, camera pose on the body, depth scale.
#pragma once

#include "core/backend/window/window.h"
#include "core/config/backend_config.h"
#include "core/imu/imu_buffer.h"
#include "core/types/odometry_update.h"

namespace stillpoint {

/// Sets what the IMU measures at the exposure of a frame to means over up to 40 ms around it, if there are
/// samples on both sides. Image velocities and the inertial residual's derivative by the time offset are
/// computed from them: the noise of a single sample would count as information about the time offset, and
/// bias it towards its current value.
void average_imu_at_exposure(const ImuBuffer& imu, WindowFrame& frame);

/// Adds the configured random walks of time offset, extrinsics and depth scale to a prior.
/// @param agrees calibration that does not walk
/// @param seconds by which the prior advances: from the oldest frame to the next one
void add_calibration_walk(const BackendConfig& config, const AgreesWithRig& agrees, double seconds,
                          LinearPrior& prior);

/// Moves the calibration of a window back into its bounds around the calibrated values of the rig: the time
/// offset and the depth scale are clamped, the translation and the rotation vector of the extrinsics relative
/// to the rig are shortened. An estimate outside of them is implausible, and IMU samples are only provided up
/// to the bound of the time offset (see `last_imu_end_of`).
/// @return which values were at their bound
CalibrationAtBound limit_calibration(const Rig& rig, const BackendConfig& config, Window& window);

}  // namespace stillpoint
