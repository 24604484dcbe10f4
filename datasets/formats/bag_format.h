// SPDX-License-Identifier: BSD-3-Clause
/// Reads bags of ROS 1 and ROS 2, and recordings of librealsense, as sequences, with selected topics; see
/// `kBagFormat` for the topics by type and name.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/types/rig.h"
#include "datasets/bags/bag_file.h"
#include "datasets/bags/bag_topics.h"
#include "datasets/formats/formats.h"

namespace stillpoint::datasets {

/// An image message with the stamp of its header.
struct StampedImage {
  Timestamp t;
  MessageReference message;
};

/// The sensor streams of a bag: inertial samples, and the stamps and positions of images.
struct BagStreams {
  std::vector<StampedImage> color;  ///< strictly increasing in time, as all streams
  std::vector<StampedImage> depth;
  std::vector<ImuSample> imu;
  std::string color_frame;  ///< coordinate frames of the first messages
  std::string depth_frame;
  std::string imu_frame;
  bool float_depth = false;           ///< whether the first depth image has values in meters
  std::vector<std::string> warnings;  ///< repeated and unordered stamps, as "LOCATION: FAULT"
};

/// Reads the messages of the selected topics in one pass over the bag; of images, only the first kilobyte
/// unless the chunk is compressed. Stamps that are 0 are replaced by the time of recording, which is shifted
/// by the median difference of the others of the topic. Messages with the stamp of an earlier one are
/// dropped, unordered ones are sorted. Accelerations of a separate topic are interpolated, see
/// `merge_onto_gyro`.
/// @throws InputError if a message is damaged, or an inertial sample is out of the range of sensors; or as
/// `faults` decides
[[nodiscard]] BagStreams read_bag_streams(const BagFile& bag, const BagTopics& topics, FaultLog& faults);

/// Frames are pairs of color and depth images less than 20 ms apart. The camera is that of CameraInfo, the
/// extrinsic that of /tf_static; depth of another camera is registered.
/// @param requested "ROLE=TOPIC", see `select_topics`
/// @throws InputError if the bag is damaged, or has no images
[[nodiscard]] SequenceContent read_bag_sequence(const std::filesystem::path& path,
                                                std::span<const std::string> requested, FaultLog& faults);

/// Accelerations in g, as in VCU-RVI, are converted to m/s^2, with a warning. There, their sign is inverted
/// as well: the specific force of a camera that is held upright points along -y of the camera, not along y.
/// @param content with its final calibration: a bag without transforms has its extrinsic in a rig.toml
[[nodiscard]] SequenceContent with_metric_accelerations(SequenceContent content);

}  // namespace stillpoint::datasets
