// SPDX-License-Identifier: BSD-3-Clause
/// The topics of a bag: what their images contain and how these are decoded, and which topics make up a
/// sequence.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "datasets/bags/bag_file.h"
#include "datasets/bags/messages.h"

namespace stillpoint::datasets {

enum class ImageContent { kColor, kDepth, kOther };

/// What an image with this `encoding` of sensor_msgs/Image contains: mono8, rgb8, bgr8, rgba8, bgra8, 8UC1,
/// 8UC3, 8UC4, yuv422 (uyvy) and yuv422_yuy2 (yuyv) are color or gray; 16UC1, mono16 and 32FC1 are depth.
[[nodiscard]] ImageContent content_of_encoding(std::string_view encoding);

/// What a sensor_msgs/CompressedImage contains: depth if `format` names compressedDepth or 16UC1, or if the
/// image is a PNG of one channel of 16 bits.
/// @param format of the message
/// @param beginning of the message
[[nodiscard]] ImageContent content_of_compressed(std::string_view format, std::string_view beginning);

/// Units per meter of depth images with values in meters (32FC1) after their conversion to 16 bits, unless a
/// rig.toml states others: the range is 13.1 m, as in the TUM benchmark.
inline constexpr double kFloatDepthUnitsPerM = 5000.0;

/// Whether depth is stored in meters; else in raw units.
[[nodiscard]] bool has_float_depth(std::string_view encoding_or_format);

/// @return CV_8UC1, or CV_8UC3 in the order R, G, B
/// @throws InputError if the encoding is not one of a color or gray image, or the data are too short
[[nodiscard]] cv::Mat decode_color_message(const ImageMessage& image, std::string_view place);
[[nodiscard]] cv::Mat decode_color_message(const CompressedImageMessage& image, std::string_view place);

/// A compressedDepth image is a PNG after a header of 12 bytes; of 32FC1, it contains quantized inverse depth
/// d = A / (raw - B), with A and B in that header (compressed_depth_image_transport).
/// @return as `read_depth`; of quantized depth, 0 = not measured
/// @throws InputError as above
[[nodiscard]] cv::Mat decode_depth_message(const ImageMessage& image, std::string_view place);
[[nodiscard]] cv::Mat decode_depth_message(const CompressedImageMessage& image, std::string_view place);

/// Selected topics; empty where the bag has none.
struct BagTopics {
  std::string color;
  std::string depth;
  std::string imu;            ///< both inertial sensors
  std::string gyro;           ///< if they are in two topics
  std::string accel;          ///< if they are in two topics
  std::string truth;          ///< poses of a reference system
  std::string unclear_depth;  ///< without depth: an image of 16 bits that no name calls depth or infrared
};

/// Selects topics by type and name.
///
/// Color: an image with a color or gray encoding; names with "color" or "rgb" are preferred to others, and
/// those of infrared and fisheye cameras come last. Depth: an image with
/// a depth encoding; those whose names begin like the color topic are preferred, then those with "aligned" or
/// "registered". Of equal ones, uncompressed images are preferred. IMU: one
/// topic for both sensors, or one with "gyro" and one with "accel" in its name; those that begin with the
/// same name as the color topic are preferred. Ground truth: poses whose topic names a reference system.
/// @param requested "ROLE=TOPIC" with a role of `BagTopics`, overrides the selection; "ROLE=" selects none
/// @throws InputError if a request is malformed or its topic is not in the bag or has another type, or there
/// is no color topic
[[nodiscard]] BagTopics select_topics(const BagFile& bag, std::span<const std::string> requested);

/// "color /a, depth /b, ..." for messages.
[[nodiscard]] std::string topics_text(const BagTopics& topics);

}  // namespace stillpoint::datasets
