// SPDX-License-Identifier: BSD-3-Clause
/// What measuring costs, measured.
#pragma once

#include "bench/run/odometry_run.h"

namespace stillpoint {

struct RecorderCost {
  double timer_ns = 0.0;  ///< of one `ScopedTimer`, median of several batches
  double timers_per_frame = 0.0;
  double keeping_us_per_frame = 0.0;  ///< taken by copying what an update says
  double share = 0.0;                 ///< of the time of the odometry's stages
};

/// Of a run that kept its spans.
[[nodiscard]] RecorderCost recorder_cost(const OdometryRun& run);

}  // namespace stillpoint
