// SPDX-License-Identifier: BSD-3-Clause
/// The channels of a recording for viewers, in Protocol Buffers: of a run that is executed
/// (run_recording.h) and of a stored one (stored_recording.h). run_recording.h lists topics and types.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "bench/model/stored_run.h"
#include "core/types/odometry_update.h"
#include "core/types/trajectory.h"
#include "datasets/bags/mcap.h"
#include "datasets/foxglove/messages.h"

namespace stillpoint::report {

/// Coordinate frames.
inline constexpr const char* kCameraFrame = "camera";
inline constexpr const char* kTruthFrame = "truth";

/// The world frame of a segment: "world", after a loss "world_1" ...
[[nodiscard]] std::string world_frame(int segment);

class RecordingChannels {
 public:
  /// Creates FILE.part, which gets its name by `finish`.
  /// @param first time of the first frame, not negative: that of the paths
  RecordingChannels(const std::filesystem::path& file, Timestamp first);

  /// Writes a message; the channel is added with the first one.
  void write(const std::string& topic, std::string_view type, Timestamp t, std::string_view message);
  void write_pose(const std::string& topic, const datasets::FoxgloveHeader& header, const Pose& pose);
  /// Nothing without poses.
  void write_path(const std::string& topic, std::string_view frame, const Trajectory& trajectory);
  void write_transform(const datasets::FoxgloveHeader& header, std::string_view child, const Pose& pose);

  /// Writes the index. The file is complete then.
  void finish() { writer_.finish(); }

 private:
  Timestamp first_;
  datasets::McapWriter writer_;
  std::map<std::string, std::uint32_t> channels_;  ///< by topic
};

/// stillpoint.Status
struct StatusMessage {
  Timestamp t;
  std::int64_t frame = 0;
  std::string_view status;
  std::string_view reason;  ///< empty if unknown
  int segment = 0;
  OdometryCounters counters;
};
[[nodiscard]] std::string encode_status(const StatusMessage& status);

/// stillpoint.Timings
/// @param samples of one frame
[[nodiscard]] std::string encode_timings(Timestamp t, std::int64_t frame,
                                         std::span<const bench::TimingSample> samples);

}  // namespace stillpoint::report
