// SPDX-License-Identifier: BSD-3-Clause
/// Time of each module and thread of one run, in the columns of the paper's Table III and below them.
#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/run/timing_statistics.h"

namespace stillpoint {

/// One module that was called; the order of rows is that of `Module`.
struct ProfileRow {
  Module module = Module::kFeatureTracking;
  TimingStatistics per_call;
  TimingStatistics per_frame;      ///< of the frames in which it was called
  std::int64_t frames_beyond = 0;  ///< frames that spent more than the budget in it
};

/// Frames whose stages together, and whose slowest stage alone, took longer than the budget: what one thread
/// and what a thread for each stage would miss.
struct DeadlineMisses {
  double budget_ms = 0.0;
  std::int64_t frames = 0;
  std::int64_t one_thread = 0;
  std::int64_t thread_per_stage = 0;
  std::optional<TimingStatistics> whole_frame;  ///< the stages together; nothing without frames
};

[[nodiscard]] std::vector<ProfileRow> profile_rows(const TimingSamples& samples, double budget_ms);

/// @param frames of a run, see `OdometryRun::frame_timings`
[[nodiscard]] DeadlineMisses deadline_misses(const std::vector<ModuleTimings>& frames, double budget_ms);

/// Lists "modules" in ms and "deadline".
[[nodiscard]] nlohmann::ordered_json profile_json(const std::vector<ProfileRow>& rows,
                                                  const DeadlineMisses& misses);

}  // namespace stillpoint
