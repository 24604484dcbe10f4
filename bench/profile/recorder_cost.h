// SPDX-License-Identifier: BSD-3-Clause
/// Overhead of the instrumentation, measured.
#pragma once

#include "bench/run/odometry_run.h"

namespace stillpoint::bench {

struct RecorderCost {
  double timer_ns = 0.0;  ///< of one `ScopedTimer`, median of several batches
  double timers_per_frame = 0.0;
  double recording_us_per_frame = 0.0;  ///< time of recording the updates
  double fraction = 0.0;                ///< of the time of the odometry's stages
};

/// @param run with recorded spans
[[nodiscard]] RecorderCost recorder_cost(const OdometryRun& run);

}  // namespace stillpoint::bench
