// SPDX-License-Identifier: BSD-3-Clause
/// Opens a sequence for commands that run the odometry on it.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/run/sequence_source.h"
#include "core/base/timestamp.h"
#include "datasets/cache/frame_cache_options.h"
#include "datasets/faults/sensor_fault.h"
#include "datasets/open_sequence.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::bench {

/// `find_sequence` with a progress line while a preset is rendered before it is returned.
/// @return null if interrupted
[[nodiscard]] std::unique_ptr<datasets::SensorStream> open_with_progress(const std::string& name,
                                                                         const datasets::OpenOptions& options,
                                                                         const PresetPart& part = {});

/// How a sequence is played.
struct Playback {
  double start_s = 0.0;  ///< see datasets/sensor_stream.h, as the next two
  int every = 1, passes = 1;
  std::vector<datasets::SensorFault> faults;
  int gray_noise = 0;      ///< seed, see datasets/faults/gray_noise.h
  std::size_t frames = 0;  ///< limit of played frames; 0 = none
  double seconds = 0.0;    ///< play the frames earlier than this after the first played one; 0 = all
};

/// Number of frames, from the first one of the sequence on, that are loaded for the played ones. Faults and
/// several passes load all.
[[nodiscard]] std::size_t frames_to_load(std::span<const Timestamp> frame_times, const Playback& playback);

/// Number of played frames. @param frame_times of the stream that `played` returned
[[nodiscard]] std::size_t frames_to_play(std::span<const Timestamp> frame_times, const Playback& playback);

/// The stream from the start on, every n-th frame of it, in passes, with noise, and with faults relative to
/// the start.
/// @param stream with at least one frame
/// @throws InputError as `start_at`, `every_nth_frame`, `ping_pong_playback` and `with_faults`
[[nodiscard]] std::unique_ptr<datasets::SensorStream> played(std::unique_ptr<datasets::SensorStream> stream,
                                                             const Playback& playback);

/// Follows the identity of the files if their calibration is overridden; then its checksum follows.
inline constexpr std::string_view kRigSuffix = "-rig-";

/// Identity of a sequence in manifests: that of a preset, or the checksum of the files; with another
/// calibration it is another sequence.
/// @param rig_file of --rig; empty without one
/// @throws InputError as `sequence_checksum`
[[nodiscard]] std::string sequence_identity(const datasets::SequenceInfo& info, const std::string& rig_file);

/// Options of the frame cache whose warnings are logged.
/// @param max_frames 0 = all
/// @return nullopt unless `enabled`, or as `frame_cache_options`
[[nodiscard]] std::optional<datasets::FrameCacheOptions> logged_frame_cache(bool enabled, int max_frames);

/// The faults of the options --fault. @throws InputError as `parse_fault`
[[nodiscard]] std::vector<datasets::SensorFault> parsed_faults(const std::vector<std::string>& texts);

}  // namespace stillpoint::bench
