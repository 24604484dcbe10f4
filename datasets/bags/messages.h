// SPDX-License-Identifier: BSD-3-Clause
/// The messages of ROS 1 and ROS 2 that describe a sequence: their fields, and how they are parsed and
/// serialized.
///
/// Both have the same fields, except that a header of ROS 1 begins with a sequence number. The bytes of ROS 1
/// have no gaps; those of CDR (OMG DDSI-RTPS 2.2, chapter 10) begin with an encapsulation identifier, and
/// align each number to its size.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/base/timestamp.h"
#include "core/geometry/pose.h"
#include "datasets/bags/bag_chunks.h"
#include "datasets/calibration/transform_graph.h"

namespace stillpoint::datasets {

/// Serialized bytes of one message, and their place for errors. Both must outlive parsed views.
struct SerializedMessage {
  std::string_view bytes;
  WireFormat format = WireFormat::kRos1;
  std::string_view place;
};

struct MessageHeader {
  Timestamp stamp;
  std::string frame;  ///< coordinate frame; without the leading slash of early ROS versions
};

/// sensor_msgs/Image
struct ImageMessage {
  MessageHeader header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding;
  bool big_endian = false;
  std::uint32_t step = 0;  ///< bytes per row
  std::string_view data;
};

/// sensor_msgs/CompressedImage
struct CompressedImageMessage {
  MessageHeader header;
  std::string format;
  std::string_view data;
};

/// sensor_msgs/RegionOfInterest [px]; of size 0: the whole image.
struct ImageRegion {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
};

/// sensor_msgs/CameraInfo: size, K and P are those of the full image, of which `region` is cut out and then
/// binned.
struct CameraInfoMessage {
  MessageHeader header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string distortion_model;
  std::vector<double> D;
  std::array<double, 9> K{};
  std::array<double, 12> P{};
  std::uint32_t binning_x = 0;  ///< 0 and 1: none
  std::uint32_t binning_y = 0;
  ImageRegion region = {};
};

/// sensor_msgs/Imu, without orientation.
struct ImuMessage {
  MessageHeader header;
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// A pose of frame `child` in the frame of the header.
struct PoseMessage {
  MessageHeader header;
  std::string child;  ///< empty if the type has none
  /// A rotation whose quaternion has no direction (0 0 0 0, or not finite) or a position that is not finite:
  /// nullopt.
  std::optional<Pose> pose;
  /// Of position and rotation about the axes of the frame of the header, row by row [m, rad]; of
  /// PoseWithCovarianceStamped and Odometry. Publishers without one leave it 0.
  std::optional<std::array<double, 36>> covariance = std::nullopt;
};

/// sensor_msgs/NavSatFix
struct NavSatFixMessage {
  MessageHeader header;
  std::int8_t status = -1;  ///< < 0: no fix
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;
};

/// Each function parses all fields in front of the last one that it returns.
/// @throws InputError if the bytes end before, or have an encapsulation that is not plain CDR
[[nodiscard]] MessageHeader parse_header(const SerializedMessage& message);
[[nodiscard]] ImageMessage parse_image(const SerializedMessage& message);
[[nodiscard]] CompressedImageMessage parse_compressed_image(const SerializedMessage& message);
[[nodiscard]] CameraInfoMessage parse_camera_info(const SerializedMessage& message);
[[nodiscard]] ImuMessage parse_imu(const SerializedMessage& message);
[[nodiscard]] NavSatFixMessage parse_nav_sat_fix(const SerializedMessage& message);

/// The fields of an image in front of its pixels; `data` is empty.
[[nodiscard]] ImageMessage parse_image_head(const SerializedMessage& message);

/// The header and format of a compressed image; `data` is empty.
[[nodiscard]] CompressedImageMessage parse_compressed_image_head(const SerializedMessage& message);

/// Types that contain one pose with a stamp: geometry_msgs/PoseStamped, PoseWithCovarianceStamped,
/// TransformStamped, and nav_msgs/Odometry.
[[nodiscard]] bool is_pose_type(std::string_view type);

/// @param type for which `is_pose_type` is true
[[nodiscard]] PoseMessage parse_pose(const SerializedMessage& message, std::string_view type);

/// The transforms of a tf2_msgs/TFMessage or tf/tfMessage.
[[nodiscard]] std::vector<PoseMessage> parse_transforms(const SerializedMessage& message);

/// geometry_msgs/Transform
[[nodiscard]] std::optional<Pose> parse_transform(const SerializedMessage& message);

/// std_msgs/Float32
[[nodiscard]] float parse_float(const SerializedMessage& message);

/// Inverse functions of the parsers above. Orientation is written as unknown (its first covariance is -1),
/// covariances as 0.
[[nodiscard]] std::string serialize(const ImuMessage& message, WireFormat format);
[[nodiscard]] std::string serialize(const ImageMessage& message, WireFormat format);
[[nodiscard]] std::string serialize(const CompressedImageMessage& message, WireFormat format);

/// R is the identity; binning and region of interest are written as 0.
[[nodiscard]] std::string serialize(const CameraInfoMessage& message, WireFormat format);

/// The altitude has no covariance.
[[nodiscard]] std::string serialize(const NavSatFixMessage& message, WireFormat format);

/// @param message with a pose
/// @param type of ROS for which `is_pose_type` is true; a covariance that is not set and velocities are 0
[[nodiscard]] std::string serialize_pose(const PoseMessage& message, std::string_view type,
                                         WireFormat format);

/// A tf2_msgs/TFMessage.
[[nodiscard]] std::string serialize_transforms(std::span<const PoseMessage> transforms, WireFormat format);

/// A geometry_msgs/Transform.
[[nodiscard]] std::string serialize_transform(const Pose& pose, WireFormat format);

/// A std_msgs/Float32.
[[nodiscard]] std::string serialize_float(float value, WireFormat format);

/// Definition of a type as connections contain it, and its MD5 sum, which identifies it in ROS 1.
struct MessageDefinition {
  std::string_view type;  ///< in the spelling of ROS 1
  std::string_view md5;
  std::string text;  ///< with the definitions of its parts
};

/// @param type of one of the messages above
[[nodiscard]] MessageDefinition definition_of(std::string_view type, WireFormat format);

}  // namespace stillpoint::datasets
