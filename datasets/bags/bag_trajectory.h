// SPDX-License-Identifier: BSD-3-Clause
/// Poses in bags as trajectories, and the fixed transforms between coordinate frames.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/bags/bag_file.h"
#include "datasets/calibration/transform_graph.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {

/// The parts of "FILE.bag:/topic".
struct BagTopic {
  std::filesystem::path bag;
  std::string topic;
};

/// @return nullopt if the text before its first ":/" is not the name of a bag
[[nodiscard]] std::optional<BagTopic> parse_bag_topic(const std::string& text);

/// The poses of a topic of type PoseStamped, PoseWithCovarianceStamped, TransformStamped or Odometry; or,
/// with the topic "/tf:PARENT.CHILD" (the notation of evo), of the frame CHILD in PARENT along the chain of
/// transforms in /tf and /tf_static. The times are those of the transform of the chain with the most
/// messages; the others are interpolated. Stamps that are 0 are replaced by the time of recording. Poses
/// without a rotation, repeated and unordered ones are skipped or sorted, and counted.
/// @throws InputError if there is no such topic, it has no poses, or the frames are not connected
[[nodiscard]] eval::LoadedTrajectory read_bag_trajectory(const BagFile& bag, const std::string& topic);

/// The transforms of /tf_static, the last one of each pair of frames.
[[nodiscard]] std::vector<NamedTransform> read_static_transforms(const BagFile& bag);

}  // namespace stillpoint::datasets
