// SPDX-License-Identifier: BSD-3-Clause
/// Rejects configurations of the estimator whose keys contradict each other.
#pragma once

#include "core/config/backend_config.h"
#include "core/config/imu_config.h"

namespace stillpoint {

/// @throws InputError if the scale is unobservable: depth is off and there is no IMU or no monocular
/// initializer; for a monocular initializer with depth; if the depth scale is to be estimated without depth
/// residuals; or if estimated calibration is to be compared with the rig without a covariance
void check_config(const BackendConfig& backend, const ImuConfig& imu);

}  // namespace stillpoint
