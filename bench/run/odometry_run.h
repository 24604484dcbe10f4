// SPDX-License-Identifier: BSD-3-Clause
/// Runs our odometry over a sequence and keeps everything that it said.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/run/timing_statistics.h"
#include "bench/run/verdict_score.h"
#include "bench/store/stored_run.h"
#include "core/pipeline/runner.h"
#include "core/types/trajectory.h"
#include "datasets/sensor_stream.h"

namespace stillpoint {

/// What to run.
struct RunSpec {
  OdometryConfig config;
  std::string mode = "sequential";  ///< or "pipelined" or "realtime"
  double speed = 1.0;               ///< of the clock of "realtime", and of a board's
  std::optional<BoardModel>
      board;                   ///< run on a virtual clock, as on that machine; `mode` is "sequential" then
  std::size_t max_frames = 0;  ///< pictures from the start; 0 = all
  bool keep_spans = false;     ///< for timelines
  bool countable = false;      ///< decodes when asked for, on a thread whose heap nobody else uses:
                               ///< instruction counts repeat
};

/// A stay in a module, and for which picture.
struct FrameSpan {
  std::int64_t frame = 0;
  ModuleSpan span;
};

/// What came of it.
struct OdometryRun {
  Trajectory trajectory;  ///< T_w_c, frame "camera"; one pose for each picture that was tracked
  RunSummary summary;
  TimingSamples timings;
  std::int64_t dynamic_features = 0;          ///< verdicts of a mover, summed over the pictures
  std::optional<VerdictScore> verdicts;       ///< where the sequence has labels; not of "realtime"
  std::vector<ModuleTimings> frame_timings;   ///< of each picture that was asked for
  std::vector<FrameSpan> spans;               ///< where they were to be kept; pictures as they were decoded
  std::vector<StateHashes> frame_hashes;      ///< likewise
  std::vector<FrameCounters> frame_counters;  ///< likewise
  std::size_t frames_planned = 0;
  std::chrono::nanoseconds recording{};  ///< taken by keeping all this
  double wall_s = 0.0;                   ///< from the first picture asked for to the last update
};

/// @param control `on_update` may be empty
/// @throws InputError for an unknown mode, a sequence without pictures, and what the runner throws
[[nodiscard]] OdometryRun run_odometry(const SensorStream& stream, const RunSpec& spec,
                                       const RunControl& control);

}  // namespace stillpoint
