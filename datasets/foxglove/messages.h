// SPDX-License-Identifier: BSD-3-Clause
/// Encodes the messages of recordings for viewers (message_types.h), and decodes poses.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/base/timestamp.h"
#include "core/geometry/camera.h"
#include "core/geometry/pose.h"

namespace stillpoint::datasets {

/// Time and coordinate frame of a message.
struct FoxgloveHeader {
  Timestamp t;
  std::string_view frame;
};

/// Encoded parts of messages: google.protobuf.Timestamp, foxglove.Vector3 and foxglove.Pose.
[[nodiscard]] std::string encode_timestamp(Timestamp t);
[[nodiscard]] std::string encode_vector(const Eigen::Vector3d& vector);
[[nodiscard]] std::string encode_pose(const Pose& pose);

/// foxglove.PoseInFrame
[[nodiscard]] std::string encode_pose_in_frame(const FoxgloveHeader& header, const Pose& pose);

/// foxglove.PosesInFrame
[[nodiscard]] std::string encode_path(const FoxgloveHeader& header, std::span<const Pose> poses);

/// foxglove.FrameTransform: the pose of the frame `child` in the frame of the header.
[[nodiscard]] std::string encode_transform(const FoxgloveHeader& header, std::string_view child,
                                           const Pose& pose);

/// foxglove.CameraCalibration
[[nodiscard]] std::string encode_camera(const FoxgloveHeader& header, const Camera& camera);

/// foxglove.CompressedImage
/// @param jpeg the bytes of a JPEG file
[[nodiscard]] std::string encode_jpeg_message(const FoxgloveHeader& header, std::string_view jpeg);

/// foxglove.RawImage of the encoding 16UC1.
/// @param pixels rows without padding
[[nodiscard]] std::string encode_deep_image(const FoxgloveHeader& header, int width,
                                            std::span<const std::uint16_t> pixels);

/// foxglove.RawImage of the encoding mono8.
/// @param pixels rows without padding
[[nodiscard]] std::string encode_mono_image(const FoxgloveHeader& header, int width,
                                            std::span<const std::uint8_t> pixels);

/// Red, green, blue in [0, 255].
struct MessageColor {
  std::uint8_t r = 0, g = 0, b = 0;
};

/// Points of an image that are drawn alike.
struct AnnotatedPoints {
  std::vector<Eigen::Vector2d> pixels;  ///< [px], not empty; pixel centers have integer coordinates
  MessageColor color;
  bool closed_line = false;  ///< a polygon instead of single points
  std::string text;          ///< at the first pixel; may be empty
};

/// foxglove.ImageAnnotations. Their origin is the corner of the first pixel: 0.5 is added to the pixels.
[[nodiscard]] std::string encode_annotations(Timestamp t, std::span<const AnnotatedPoints> annotations);

struct ColoredPoint {
  Eigen::Vector3f p = Eigen::Vector3f::Zero();  ///< [m]
  MessageColor color;
};

/// foxglove.PointCloud with the fields x, y, z, red, green, blue, alpha.
[[nodiscard]] std::string encode_point_cloud(const FoxgloveHeader& header,
                                             std::span<const ColoredPoint> points);

inline constexpr std::string_view kPoseInFrameType = "foxglove.PoseInFrame";

/// A decoded foxglove.PoseInFrame.
struct PoseInFrameMessage {
  Timestamp t;
  std::string frame;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = {0.0, 0.0, 0.0, 0.0};  ///< as stored; all zero if absent
};

/// @param place for errors
/// @throws InputError if the message is damaged
[[nodiscard]] PoseInFrameMessage decode_pose_in_frame(std::string_view bytes, std::string_view place);

}  // namespace stillpoint::datasets
