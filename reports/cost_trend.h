// SPDX-License-Identifier: BSD-3-Clause
/// Whether a long run costs more the longer it lasts.
#pragma once

#include <span>
#include <vector>

#include "bench/run/odometry_run.h"
#include "eval/statistics/bootstrap.h"
#include "reports/drawing.h"

namespace stillpoint {

/// What one frame cost.
struct FrameCost {
  double t_s = 0.0;  ///< since the first frame
  double ms = 0.0;
};

/// Of tracking and optimisation together, frame by frame.
[[nodiscard]] std::vector<FrameCost> frame_costs(const OdometryRun& run);

/// A straight line through the medians of equal stretches of time.
struct CostTrend {
  std::vector<FrameCost> medians;  ///< at the middle of each stretch
  double start_ms = 0.0;           ///< of the line, at time 0
  double slope_ms_per_min = 0.0;
  Interval slope_interval;  ///< 95 %, from the scatter of the medians about the line
};

/// @param costs     by rising time
/// @param stretch_s of which the median is taken: it forgets frames that the machine held up
/// @throws InputError where there are fewer than three stretches
[[nodiscard]] CostTrend cost_trend(std::span<const FrameCost> costs, double stretch_s = 10.0);

/// The medians and the line.
[[nodiscard]] Drawing cost_plot(const CostTrend& trend);

}  // namespace stillpoint
