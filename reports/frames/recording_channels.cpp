// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/recording_channels.h"

#include <vector>

#include "datasets/foxglove/message_types.h"
#include "datasets/foxglove/protobuf.h"

namespace stillpoint::report {

using datasets::FoxgloveHeader;
using datasets::ProtobufWriter;

std::string world_frame(int segment) { return segment == 0 ? "world" : "world_" + std::to_string(segment); }

RecordingChannels::RecordingChannels(const std::filesystem::path& file, Timestamp first)
    : first_(first), writer_(file, datasets::ChunkCompression::kZstd, "") {}

void RecordingChannels::write(const std::string& topic, std::string_view type, Timestamp t,
                              std::string_view message) {
  auto channel = channels_.find(topic);
  if (channel == channels_.end()) {
    const std::uint32_t added = writer_.add_channel({.topic = topic,
                                                     .message_encoding = "protobuf",
                                                     .type = std::string(type),
                                                     .schema_encoding = "protobuf",
                                                     .schema = datasets::protobuf_schema(type)});
    channel = channels_.emplace(topic, added).first;
  }
  writer_.write(channel->second, t, message);
}

void RecordingChannels::write_pose(const std::string& topic, const FoxgloveHeader& header, const Pose& pose) {
  write(topic, "foxglove.PoseInFrame", header.t, datasets::encode_pose_in_frame(header, pose));
}

void RecordingChannels::write_path(const std::string& topic, std::string_view frame,
                                   const Trajectory& trajectory) {
  if (trajectory.poses.empty()) return;
  std::vector<Pose> poses;
  poses.reserve(trajectory.poses.size());
  for (const StampedPose& pose : trajectory.poses) poses.push_back(pose.T_w_f);
  write(topic, "foxglove.PosesInFrame", first_, datasets::encode_path({first_, frame}, poses));
}

void RecordingChannels::write_transform(const FoxgloveHeader& header, std::string_view child,
                                        const Pose& pose) {
  write("/tf", "foxglove.FrameTransform", header.t, datasets::encode_transform(header, child, pose));
}

std::string encode_status(const StatusMessage& status) {
  const OdometryCounters& counters = status.counters;
  return ProtobufWriter()
      .bytes(1, datasets::encode_timestamp(status.t))
      .integer(2, status.frame)
      .bytes(3, status.status)
      .bytes(4, status.reason)
      .integer(5, status.segment)
      .integer(6, counters.tracked_features)
      .integer(7, counters.window_landmarks)
      .integer(8, counters.depth_landmarks)
      .integer(9, counters.dynamic_features)
      .integer(10, counters.solver_iterations)
      .integer(11, counters.keyframe ? 1 : 0)
      .integer(12, counters.reset ? 1 : 0)
      .take();
}

std::string encode_timings(Timestamp t, std::int64_t frame, std::span<const bench::TimingSample> samples) {
  ProtobufWriter message;
  message.bytes(1, datasets::encode_timestamp(t)).integer(2, frame);
  for (const bench::TimingSample& sample : samples) {
    message.bytes(3, ProtobufWriter()
                         .bytes(1, sample.module)
                         .number(2, static_cast<double>(sample.ns) * 1e-6)
                         .integer(3, sample.calls)
                         .take());
  }
  return message.take();
}

}  // namespace stillpoint::report
