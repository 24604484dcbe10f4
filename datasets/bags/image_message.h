// SPDX-License-Identifier: BSD-3-Clause
/// Pixels of image messages.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string_view>

#include "datasets/bags/messages.h"

namespace stillpoint::datasets {

enum class ImageContent { kColor, kDepth, kOther };

/// What an image with this `encoding` of sensor_msgs/Image contains: mono8, rgb8, bgr8, rgba8, bgra8, 8UC1,
/// 8UC3, 8UC4, yuv422 and yuv422_yuy2 are color or gray; 16UC1, mono16 and 32FC1 are depth.
[[nodiscard]] ImageContent content_of_encoding(std::string_view encoding);

/// What an image with this `format` of sensor_msgs/CompressedImage contains: depth if it names
/// compressedDepth.
[[nodiscard]] ImageContent content_of_format(std::string_view format);

/// Units per meter of depth images with values in meters (32FC1) after their conversion to 16 bits: the
/// range is 13.1 m, as in the TUM benchmark.
inline constexpr double kFloatDepthUnitsPerM = 5000.0;

/// Whether depth is stored in meters, that is, in `kFloatDepthUnitsPerM` after decoding; else in raw units.
[[nodiscard]] bool has_float_depth(std::string_view encoding_or_format);

/// @return CV_8UC1, or CV_8UC3 in the order R, G, B
/// @throws InputError if the encoding is not one of a color or gray image, or the data are too short
[[nodiscard]] cv::Mat decode_color_message(const ImageMessage& image, std::string_view place);
[[nodiscard]] cv::Mat decode_color_message(const CompressedImageMessage& image, std::string_view place);

/// Depth of 32 bits is rounded to 1/`kFloatDepthUnitsPerM` m; values that are not finite, not positive or too
/// large become 0. A compressedDepth image is a PNG after a header of 12 bytes; of 32FC1, it contains
/// quantized inverse depth d = A / (raw - B), with A and B in that header (compressed_depth_image_transport).
/// @return CV_16UC1, 0 = not measured
/// @throws InputError as above
[[nodiscard]] cv::Mat decode_depth_message(const ImageMessage& image, std::string_view place);
[[nodiscard]] cv::Mat decode_depth_message(const CompressedImageMessage& image, std::string_view place);

}  // namespace stillpoint::datasets
