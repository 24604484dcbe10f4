// SPDX-License-Identifier: BSD-3-Clause
/// Opens the sequence of a run, and plays it as requested.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/faults/sensor_fault.h"
#include "datasets/open_sequence.h"

namespace stillpoint::bench {

/// `find_sequence` with a progress line while a preset is rendered.
/// @return null if interrupted
[[nodiscard]] std::unique_ptr<datasets::SensorStream> open_with_progress(
    const std::string& name, const datasets::OpenOptions& options);

/// How a sequence is played.
struct Playback {
  double start_s = 0.0;  ///< see datasets/playback_start.h
  int passes = 1;        ///< see datasets/ping_pong_playback.h
  std::vector<datasets::SensorFault> faults;
};

/// The stream from the start on, in passes, with faults relative to the start.
/// @param stream with at least one frame
/// @throws InputError as `start_at`, `ping_pong_playback` and `with_faults`
[[nodiscard]] std::unique_ptr<datasets::SensorStream> played(std::unique_ptr<datasets::SensorStream> stream,
                                                             const Playback& playback);

/// Options of the frame cache whose warnings are logged.
/// @param max_frames 0 = all
/// @return nullopt unless `enabled`, or as `frame_cache_options`
[[nodiscard]] std::optional<datasets::FrameCacheOptions> logged_frame_cache(bool enabled, int max_frames);

}  // namespace stillpoint::bench
