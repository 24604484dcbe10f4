// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/image_message.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "datasets/bags/byte_reader.h"
#include "datasets/io/image_io.h"

namespace stillpoint::datasets {
namespace {

/// Channels of an encoding: their number, and the positions of red, green and blue.
struct ColorLayout {
  std::string_view encoding;
  int channels = 1;
  std::array<int, 3> rgb{};
};

/// 8UC3 does not define its order; camera nodes write it from OpenCV, that is, B G R.
constexpr std::array<ColorLayout, 8> kColorLayouts{{{"mono8", 1, {0, 0, 0}},
                                                    {"8UC1", 1, {0, 0, 0}},
                                                    {"rgb8", 3, {0, 1, 2}},
                                                    {"bgr8", 3, {2, 1, 0}},
                                                    {"8UC3", 3, {2, 1, 0}},
                                                    {"rgba8", 4, {0, 1, 2}},
                                                    {"bgra8", 4, {2, 1, 0}},
                                                    {"8UC4", 4, {2, 1, 0}}}};
constexpr std::size_t kCompressedDepthHeader = 12;
constexpr std::uint32_t kMaxImageSize = 65535;  ///< [px] of a side

const ColorLayout* find_layout(std::string_view encoding) {
  const auto found = std::ranges::find(kColorLayouts, encoding, &ColorLayout::encoding);
  return found == kColorLayouts.end() ? nullptr : &*found;
}

/// Whether the pixels are Y and alternating U and V. ROS names the order U Y V Y "yuv422".
bool is_yuv(std::string_view encoding) { return encoding.starts_with("yuv422"); }

/// @throws InputError unless the rows of `bytes_per_pixel` fit in the data
void require_pixels(const ImageMessage& image, std::uint64_t bytes_per_pixel, std::string_view place) {
  const bool valid = image.width > 0 && image.height > 0 && image.width <= kMaxImageSize &&
                     image.height <= kMaxImageSize && image.step >= image.width * bytes_per_pixel &&
                     image.data.size() >= std::uint64_t{image.step} * image.height;
  if (!valid)
    throw InputError(std::string(place), "its size " + std::to_string(image.width) + "x" +
                                             std::to_string(image.height) +
                                             " does not fit its data; it is damaged, record it again");
}

std::uint8_t clamp_to_byte(double value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

/// ITU-R BT.601 with full range, as OpenCV converts it:
///   R = Y + 1.402 (V - 128),  G = Y - 0.344 (U - 128) - 0.714 (V - 128),  B = Y + 1.772 (U - 128)
cv::Vec3b rgb_of(int y, int u, int v) {
  return {clamp_to_byte(y + 1.402 * (v - 128)),
          clamp_to_byte(y - 0.344136 * (u - 128) - 0.714136 * (v - 128)),
          clamp_to_byte(y + 1.772 * (u - 128))};
}

cv::Mat decode_yuv(const ImageMessage& image, std::string_view place) {
  require_pixels(image, 2, place);
  const std::size_t luma_first = image.encoding == "yuv422_yuy2" ? 0 : 1;
  const std::size_t chroma_first = 1 - luma_first;
  cv::Mat rgb(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC3);
  for (int row = 0; row < rgb.rows; ++row) {
    const auto* const in =
        reinterpret_cast<const std::uint8_t*>(image.data.data()) + static_cast<std::size_t>(row) * image.step;
    for (int column = 0; column < rgb.cols; ++column) {
      const std::size_t pair = static_cast<std::size_t>(column / 2) * 4;
      // A row of odd width ends without the V of its last pair.
      const std::size_t v_at =
          pair + 2 + chroma_first < image.step ? pair + 2 + chroma_first : pair + chroma_first;
      rgb.at<cv::Vec3b>(row, column) =
          rgb_of(in[static_cast<std::size_t>(column) * 2 + luma_first], in[pair + chroma_first], in[v_at]);
    }
  }
  return rgb;
}

/// A depth in meters in units of `kFloatDepthUnitsPerM`; 0 if it is not a measurement.
std::uint16_t units_of(float depth_m) {
  const double units = std::round(depth_m * kFloatDepthUnitsPerM);
  if (!(units >= 1.0 && units <= std::numeric_limits<std::uint16_t>::max())) return 0;
  return static_cast<std::uint16_t>(units);
}

cv::Mat decode_inverse_depth(const cv::Mat& quantized, float a, float b) {
  cv::Mat depth(quantized.size(), CV_16UC1);
  std::transform(quantized.begin<std::uint16_t>(), quantized.end<std::uint16_t>(),
                 depth.begin<std::uint16_t>(), [a, b](std::uint16_t raw) -> std::uint16_t {
                   return raw == 0 ? 0 : units_of(a / (static_cast<float>(raw) - b));
                 });
  return depth;
}

}  // namespace

ImageContent content_of_encoding(std::string_view encoding) {
  if (find_layout(encoding) != nullptr || is_yuv(encoding)) return ImageContent::kColor;
  if (encoding == "16UC1" || encoding == "mono16" || encoding == "32FC1") return ImageContent::kDepth;
  return ImageContent::kOther;
}

ImageContent content_of_format(std::string_view format) {
  return format.find("compressedDepth") != std::string_view::npos || format.starts_with("16UC1")
             ? ImageContent::kDepth
             : ImageContent::kColor;
}

bool has_float_depth(std::string_view encoding_or_format) { return encoding_or_format.starts_with("32FC1"); }

cv::Mat decode_color_message(const ImageMessage& image, std::string_view place) {
  if (is_yuv(image.encoding)) return decode_yuv(image, place);
  const ColorLayout* const layout = find_layout(image.encoding);
  if (layout == nullptr)
    throw InputError(std::string(place),
                     "the encoding \"" + image.encoding +
                         "\" is not one of a color or gray image; select another topic with --topics");
  require_pixels(image, static_cast<std::uint64_t>(layout->channels), place);
  cv::Mat pixels(static_cast<int>(image.height), static_cast<int>(image.width),
                 layout->channels == 1 ? CV_8UC1 : CV_8UC3);
  for (int row = 0; row < pixels.rows; ++row) {
    const auto* in =
        reinterpret_cast<const std::uint8_t*>(image.data.data()) + static_cast<std::size_t>(row) * image.step;
    std::uint8_t* out = pixels.ptr<std::uint8_t>(row);
    if (layout->channels == 1) {
      std::copy_n(in, image.width, out);
      continue;
    }
    for (int column = 0; column < pixels.cols; ++column, in += layout->channels, out += 3) {
      for (std::size_t i = 0; i < 3; ++i) out[i] = in[layout->rgb[i]];
    }
  }
  return pixels;
}

cv::Mat decode_color_message(const CompressedImageMessage& image, std::string_view place) {
  return decode_image(image.data, std::string(place));
}

cv::Mat decode_depth_message(const ImageMessage& image, std::string_view place) {
  const bool is_float = has_float_depth(image.encoding);
  if (content_of_encoding(image.encoding) != ImageContent::kDepth)
    throw InputError(std::string(place),
                     "the encoding \"" + image.encoding +
                         "\" is not one of a depth image; select another topic with --topics");
  require_pixels(image, is_float ? 4 : 2, place);
  cv::Mat depth(static_cast<int>(image.height), static_cast<int>(image.width), CV_16UC1);
  for (int row = 0; row < depth.rows; ++row) {
    ByteReader reader(image.data.substr(static_cast<std::size_t>(row) * image.step, image.step), place,
                      {.big_endian = image.big_endian});
    for (int column = 0; column < depth.cols; ++column) {
      depth.at<std::uint16_t>(row, column) =
          is_float ? units_of(reader.number<float>()) : reader.number<std::uint16_t>();
    }
  }
  return depth;
}

cv::Mat decode_depth_message(const CompressedImageMessage& image, std::string_view place) {
  const bool has_header = image.format.find("compressedDepth") != std::string::npos;
  if (image.format.find("rvl") != std::string::npos)
    throw InputError(std::string(place), "depth compressed by RVL is not read; record it as PNG");
  ByteReader reader(image.data, place);
  if (!has_header) return decode_depth(image.data, std::string(place));
  reader.skip(4);
  const float a = reader.number<float>();
  const float b = reader.number<float>();
  const cv::Mat raw = decode_depth(image.data.substr(kCompressedDepthHeader), std::string(place));
  return has_float_depth(image.format) ? decode_inverse_depth(raw, a, b) : raw;
}

}  // namespace stillpoint::datasets
