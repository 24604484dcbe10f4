// SPDX-License-Identifier: BSD-3-Clause
/// Serializes messages: the inverse of the functions of datasets/bags/messages.h.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "datasets/bags/messages.h"

namespace stillpoint::datasets {

/// Orientation is written as unknown (its first covariance is -1), covariances as 0.
[[nodiscard]] std::string serialize(const ImuMessage& message, WireFormat format);
[[nodiscard]] std::string serialize(const ImageMessage& message, WireFormat format);
[[nodiscard]] std::string serialize(const CompressedImageMessage& message, WireFormat format);

/// R is the identity; binning and region of interest are 0.
[[nodiscard]] std::string serialize(const CameraInfoMessage& message, WireFormat format);

/// The altitude has no covariance.
[[nodiscard]] std::string serialize(const NavSatFixMessage& message, WireFormat format);

/// @param message with a pose
/// @param type for which `is_pose_type` is true; covariances and velocities are 0
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
