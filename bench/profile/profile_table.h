// SPDX-License-Identifier: BSD-3-Clause
/// Time per module and thread of one run, extending the columns of Paper Table III, and the cost of measuring
/// it.
#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/run/odometry_run.h"

namespace stillpoint::bench {

/// One module with at least one call; rows are in the order of `Module`.
struct ProfileRow {
  Module module = Module::kFeatureTracking;
  TimingStatistics per_call;
  TimingStatistics per_frame;    ///< over the frames in which it was called
  std::int64_t frames_over = 0;  ///< frames that spent more than the budget in it
};

/// Number of frames that would miss the deadline: with one thread (sum of the stages exceeds the budget), and
/// with one thread per stage (slowest stage exceeds the budget).
struct DeadlineMisses {
  double budget_ms = 0.0;
  std::int64_t frames = 0;
  std::int64_t one_thread = 0;
  std::int64_t thread_per_stage = 0;
  std::optional<TimingStatistics> whole_frame;  ///< sum of the stages; nothing without frames
};

[[nodiscard]] std::vector<ProfileRow> profile_rows(const TimingSamples& samples, double budget_ms);

/// @param frames of a run, see `OdometryRun::frame_timings`
[[nodiscard]] DeadlineMisses deadline_misses(const std::vector<ModuleTimings>& frames, double budget_ms);

/// JSON with "modules" [ms], "whole_frame_ms" and "deadline".
[[nodiscard]] nlohmann::ordered_json profile_json(const std::vector<ProfileRow>& rows,
                                                  const DeadlineMisses& misses);

/// Overhead of the instrumentation, measured.
struct RecorderCost {
  double timer_ns = 0.0;  ///< of one `ScopedTimer`, median of several batches
  double timers_per_frame = 0.0;
  double recording_us_per_frame = 0.0;  ///< time of recording the updates
  double fraction = 0.0;                ///< of the time of the odometry's stages
};

/// @param run with recorded spans
[[nodiscard]] RecorderCost recorder_cost(const OdometryRun& run);

}  // namespace stillpoint::bench
