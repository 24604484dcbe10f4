// SPDX-License-Identifier: BSD-3-Clause
/// Scores the poses at IMU rate of a run.
#pragma once

#include "bench/model/metrics.h"
#include "core/pipeline/runners/imu_rate_poses.h"

namespace stillpoint::bench {

/// Each number is absent if there is no data for it.
/// @param gt of the camera
/// @param frame_rate trajectory of the same run at frame rate
[[nodiscard]] ImuRateScore score_imu_rate(const Trajectory& gt, const ImuRateOutput& output,
                                          const Trajectory& frame_rate);

}  // namespace stillpoint::bench
