// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/cache/frame_codec.h"

#include <blosc.h>

#include <cstdint>
#include <utility>

#include "core/base/error.h"

namespace stillpoint::datasets {
namespace {

constexpr int kLevel = 5;  ///< default of Blosc
constexpr const char* kCodec = "lz4";

/// The functions with a context take no settings from the environment and start no threads.
std::string compress(const cv::Mat& pixels, int shuffle) {
  const std::size_t bytes = pixels.total() * pixels.elemSize();
  std::string packed(bytes + BLOSC_MAX_OVERHEAD, '\0');
  const int size = blosc_compress_ctx(kLevel, shuffle, pixels.elemSize(), bytes, pixels.data, packed.data(),
                                      packed.size(), kCodec, 0, 1);
  STILLPOINT_CHECK(size > 0);  // incompressible data are stored, which needs the overhead only
  packed.resize(static_cast<std::size_t>(size));
  return packed;
}

std::optional<cv::Mat> decompress(std::string_view packed, cv::Size size, int type) {
  cv::Mat pixels(size, type);
  const std::size_t expected = pixels.total() * pixels.elemSize();
  std::size_t bytes = 0;
  if (packed.size() < BLOSC_MIN_HEADER_LENGTH) return std::nullopt;
  if (blosc_cbuffer_validate(packed.data(), packed.size(), &bytes) != 0 || bytes != expected)
    return std::nullopt;
  const int decompressed = blosc_decompress_ctx(packed.data(), pixels.data, expected, 1);
  if (decompressed < 0 || static_cast<std::size_t>(decompressed) != expected) return std::nullopt;
  return pixels;
}

cv::Mat continuous(const cv::Mat& image) { return image.isContinuous() ? image : image.clone(); }

}  // namespace

PackedFrame pack_frame(const Frame& frame) {
  std::string images = pack_gray(frame.gray);
  const std::size_t gray_bytes = images.size();
  if (!frame.depth.empty()) images += pack_depth(frame.depth);
  return {.has_color = !frame.color.empty() || frame.decode_color,
          .images = std::move(images),
          .gray_bytes = gray_bytes};
}

std::string pack_gray(const cv::Mat& gray) {
  STILLPOINT_CHECK(gray.type() == CV_8UC1 && !gray.empty());
  cv::Mat differences(gray.size(), CV_8UC1);
  gray.row(0).copyTo(differences.row(0));
  for (int row = 1; row < gray.rows; ++row) {
    const std::uint8_t* const above = gray.ptr<std::uint8_t>(row - 1);
    const std::uint8_t* const pixels = gray.ptr<std::uint8_t>(row);
    std::uint8_t* const out = differences.ptr<std::uint8_t>(row);
    for (int column = 0; column < gray.cols; ++column)
      out[column] = static_cast<std::uint8_t>(pixels[column] - above[column]);
  }
  return compress(differences, BLOSC_BITSHUFFLE);
}

std::string pack_depth(const cv::Mat& depth) {
  STILLPOINT_CHECK(depth.type() == CV_16UC1 && !depth.empty());
  return compress(continuous(depth), BLOSC_SHUFFLE);
}

std::optional<cv::Mat> unpack_gray(std::string_view packed, cv::Size size) {
  std::optional<cv::Mat> gray = decompress(packed, size, CV_8UC1);
  if (!gray) return std::nullopt;
  for (int row = 1; row < gray->rows; ++row) {
    const std::uint8_t* const above = gray->ptr<std::uint8_t>(row - 1);
    std::uint8_t* const pixels = gray->ptr<std::uint8_t>(row);
    for (int column = 0; column < gray->cols; ++column)
      pixels[column] = static_cast<std::uint8_t>(pixels[column] + above[column]);
  }
  return gray;
}

std::optional<cv::Mat> unpack_depth(std::string_view packed, cv::Size size) {
  return decompress(packed, size, CV_16UC1);
}

}  // namespace stillpoint::datasets
