// SPDX-License-Identifier: BSD-3-Clause
/// Plots of what a long run costs: the trend of the processing time per frame, and the time of the loop
/// closure per keyframe with the memory that it uses.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "bench/run/odometry_run.h"
#include "core/types/loop_report.h"
#include "eval/statistics/rank_tests.h"
#include "reports/drawing/drawing.h"

namespace stillpoint::report {

/// Processing time of one frame.
struct FrameCost {
  double t_s = 0.0;  ///< since the first frame
  double ms = 0.0;
};

/// Sum of tracking and optimization time of each frame.
[[nodiscard]] std::vector<FrameCost> frame_costs(const bench::OdometryRun& run);

/// Least-squares line y = a + b t through the medians (t_i, y_i) of n time windows of equal length:
///   b = S_ty / S_tt,  a = mean(y) - b mean(t),
///   S_tt = sum (t_i - mean(t))^2,  S_ty = sum (t_i - mean(t)) (y_i - mean(y)).
/// The 95 % interval of b is b +- q sqrt(sum (y_i - a - b t_i)^2 / (n - 2) / S_tt), q: 97.5 % quantile of
/// Student's t with n - 2 degrees of freedom.
struct CostTrend {
  std::vector<FrameCost> medians;                ///< at the center of each window
  double start_ms = 0.0;                         ///< a
  double slope_ms_per_min = 0.0;                 ///< 60 b
  std::optional<eval::Interval> slope_interval;  ///< 95 % [ms/min]; nullopt for n < 5
};

/// @param costs    by rising time
/// @param window_s length of a window; its median suppresses frames delayed by other processes
/// @throws InputError with fewer than three windows
[[nodiscard]] CostTrend cost_trend(std::span<const FrameCost> costs, double window_s = 10.0);

/// The medians and the fitted line.
[[nodiscard]] Drawing cost_plot(const CostTrend& trend);

/// Discs: median time of the keyframes of windows of equal length; line: memory at the center of each window.
/// Each has a scale of its own from 0 to the largest value, which the labels state.
/// @param keyframes by time
/// @param window_s length of a window; its median suppresses the keyframes at which the graph is optimized
/// @throws InputError if the keyframes extend over fewer than three windows
[[nodiscard]] Drawing loop_cost_plot(std::span<const MapKeyframe> keyframes, double window_s = 10.0);

}  // namespace stillpoint::report
