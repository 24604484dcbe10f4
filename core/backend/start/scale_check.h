// SPDX-License-Identifier: BSD-3-Clause
/// Rejects configurations in which the scale is unobservable.
#pragma once

#include "core/config/backend_config.h"
#include "core/config/imu_config.h"

namespace stillpoint {

/// @throws InputError if depth is off and there is no IMU or no monocular initializer, and for a monocular
/// initializer with depth; if the depth scale is to be estimated without depth residuals
void check_scale(const BackendConfig& backend, const ImuConfig& imu);

}  // namespace stillpoint
