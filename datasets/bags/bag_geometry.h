// SPDX-License-Identifier: BSD-3-Clause
/// Geometry of a bag: poses of a topic as a trajectory, the fixed transforms between coordinate frames, and
/// the calibration of the cameras.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/camera.h"
#include "datasets/bags/bag_file.h"
#include "datasets/bags/messages.h"
#include "datasets/calibration/transform_graph.h"
#include "eval/io/covariance_file.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::datasets {

/// The parts of "FILE.bag:/topic".
struct BagTopic {
  std::filesystem::path bag;
  std::string topic;
};

/// The topic gets a leading slash if it has none.
/// @return nullopt if no text before a ":" is the name of a bag
[[nodiscard]] std::optional<BagTopic> parse_bag_topic(const std::string& text);

/// Whether `read_bag_trajectory` reads a topic of this type.
[[nodiscard]] bool is_trajectory_type(std::string_view type);

/// The poses of a topic of type PoseStamped, PoseWithCovarianceStamped, TransformStamped, Odometry or (MCAP)
/// foxglove.PoseInFrame; the positions of a NavSatFix, as those of `eval::parse_nmea`; or, with the topic
/// "/tf:PARENT.CHILD" (the notation of evo), of the frame CHILD in PARENT along the chain of transforms in
/// /tf and /tf_static. The times are those of the transform of the chain with the most messages; the others
/// are interpolated. Stamps that are 0 are replaced by the time of recording. Poses without a rotation,
/// repeated and unordered ones are skipped or sorted, and counted.
/// @throws InputError if there is no such topic, it has no poses, or the frames are not connected
[[nodiscard]] eval::LoadedTrajectory read_bag_trajectory(const BagFile& bag, const std::string& topic);

/// The same, of a bag that is opened for it. @throws InputError also as `BagFile`
[[nodiscard]] eval::LoadedTrajectory read_bag_trajectory(const BagTopic& source);

/// The covariances of the poses of a topic, of PoseWithCovarianceStamped or Odometry; empty for other types.
[[nodiscard]] std::vector<eval::StampedCovariance> read_bag_covariances(const BagTopic& source);

/// The transforms of /tf_static, the last one of each pair of frames.
[[nodiscard]] std::vector<NamedTransform> read_static_transforms(const BagFile& bag);

/// These, and the transforms of /tf that never change, which static_transform_publisher of ROS 1 repeats
/// there.
[[nodiscard]] std::vector<NamedTransform> read_fixed_transforms(const BagFile& bag);

/// The first camera info of an image topic: of the topic `camera_info` beside it, in recordings of
/// librealsense of `info/camera_info`, else of any topic whose message has the frame of the images.
/// @return nullopt without one, or if it is not calibrated (fx = 0)
[[nodiscard]] std::optional<CameraInfoMessage> find_camera_info(const BagFile& bag,
                                                                const std::string& image_topic,
                                                                const std::string& image_frame);

/// The camera of an image topic. A topic with a word of its name that begins with "rect" has rectified
/// images: focal lengths and principal point of P, without distortion. Others: K and D, with the models of
/// `with_lens`, and any model whose coefficients are all 0. Region of interest and binning are applied.
/// @throws InputError if the distortion model is another one
[[nodiscard]] Camera camera_of(const CameraInfoMessage& info, const std::string& image_topic,
                               const std::string& place);

/// Recordings of librealsense: topics /device_N/sensor_M/STREAM/..., no frames in the headers. Their
/// extrinsics are in the topics STREAM/tf/REFERENCE.
struct RealsenseStreams {
  std::vector<NamedTransform> links;  ///< the streams, named as by `realsense_stream`, in their reference
  double depth_units_per_m = 1000.0;
};

/// "/device_0/sensor_1/Color_0" of a topic of that stream; nullopt in other bags.
[[nodiscard]] std::optional<std::string> realsense_stream(const std::string& topic);

/// Reads the extrinsics and the unit of depth.
[[nodiscard]] RealsenseStreams read_realsense_streams(const BagFile& bag);

}  // namespace stillpoint::datasets
