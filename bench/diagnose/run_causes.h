// SPDX-License-Identifier: BSD-3-Clause
/// What a run of the odometry contradicts: the calibration, the noise of the IMU, recorded boxes.
#pragma once

#include <string>
#include <vector>

#include "bench/diagnose/cause.h"
#include "bench/run/odometry_run.h"

namespace stillpoint::bench {

/// Causes by the differences of the rig report, the innovations, the boxes, and the features.
[[nodiscard]] std::vector<Cause> run_causes(const OdometryRun& run, const datasets::SequenceInfo& info);

/// Whether the run tells the center of the camera, right or not.
[[nodiscard]] bool observes_center(const EstimatedCalibration& calibration);

}  // namespace stillpoint::bench
