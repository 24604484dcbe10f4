// SPDX-License-Identifier: BSD-3-Clause
/// Online calibration with the consistent prior, in which information about the calibration accumulates.
#pragma once

#include "core/backend/window/window.h"
#include "core/config/backend_config.h"
#include "core/imu/imu_buffer.h"

namespace stillpoint {

/// Sets the angular rates of the newest two frames to means over 40 ms around their exposures, as far as
/// the samples reach. Image velocities are computed from them, and the time offset is observed by differences
/// of image velocities: the noise of a single sample would count as information about it.
void smooth_newest_rates(const ImuBuffer& imu, Window& window);

/// Adds the configured random walks of time offset and extrinsics to the prior, for the interval between the
/// newest two frames.
void add_calibration_walk(const BackendConfig& config, Window& window);

/// Limits the time offset to `time_offset_max_s` around the calibrated value. @return whether it was beyond
bool bound_time_offset(const BackendConfig& config, double calibrated_s, Window& window);

}  // namespace stillpoint
