// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/materials/texture.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/error.h"

namespace stillpoint::synth {
namespace {

std::uint32_t pack(const cv::Vec3b& rgb) {
  return static_cast<std::uint32_t>(rgb[0] | rgb[1] << 8 | rgb[2] << 16);
}

Float4 unpack(std::uint32_t texel) {
  using Bytes = std::uint8_t __attribute__((vector_size(4)));
  return __builtin_convertvector(std::bit_cast<Bytes>(texel), Float4);
}

cv::Vec3b average(const cv::Mat& rgb, int row, int column) {
  cv::Vec3i sum(2, 2, 2);  // rounds to nearest
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      sum +=
          cv::Vec3i(rgb.at<cv::Vec3b>(std::min(row + dy, rgb.rows - 1), std::min(column + dx, rgb.cols - 1)));
    }
  }
  return cv::Vec3b(static_cast<std::uint8_t>(sum[0] / 4), static_cast<std::uint8_t>(sum[1] / 4),
                   static_cast<std::uint8_t>(sum[2] / 4));
}

cv::Mat halved(const cv::Mat& rgb) {
  cv::Mat half(std::max(1, rgb.rows / 2), std::max(1, rgb.cols / 2), CV_8UC3);
  for (int row = 0; row < half.rows; ++row) {
    for (int column = 0; column < half.cols; ++column) {
      half.at<cv::Vec3b>(row, column) = average(rgb, 2 * row, 2 * column);
    }
  }
  return half;
}

}  // namespace

Texture::Texture(const cv::Mat& rgb) {
  STILLPOINT_CHECK(rgb.type() == CV_8UC3 && std::has_single_bit(static_cast<unsigned>(rgb.cols)) &&
                   std::has_single_bit(static_cast<unsigned>(rgb.rows)));
  for (cv::Mat level = rgb;; level = halved(level)) {
    levels_.push_back({level.cols, level.rows, texels_.size()});
    for (int row = 0; row < level.rows; ++row) {
      for (int column = 0; column < level.cols; ++column)
        texels_.push_back(pack(level.at<cv::Vec3b>(row, column)));
    }
    if (level.cols == 1 && level.rows == 1) break;
  }
}

Float4 Texture::sample(float s, float t, float level) const {
  const auto highest = static_cast<int>(levels_.size()) - 1;
  const Level& mip = levels_[static_cast<std::size_t>(std::clamp(static_cast<int>(level), 0, highest))];
  const float x = s * static_cast<float>(mip.width) - 0.5F;
  const float y = t * static_cast<float>(mip.height) - 0.5F;
  const float floor_x = std::floor(x), floor_y = std::floor(y);
  const float weight_x = x - floor_x, weight_y = y - floor_y;
  const int column = static_cast<int>(floor_x) & (mip.width - 1),
            row = static_cast<int>(floor_y) & (mip.height - 1);
  const int next_column = (column + 1) & (mip.width - 1), next_row = (row + 1) & (mip.height - 1);
  const std::uint32_t* upper = texels_.data() + mip.first + static_cast<std::size_t>(row * mip.width);
  const std::uint32_t* lower = texels_.data() + mip.first + static_cast<std::size_t>(next_row * mip.width);
  const Float4 a = unpack(upper[column]), b = unpack(upper[next_column]);
  const Float4 c = unpack(lower[column]), d = unpack(lower[next_column]);
  const Float4 top = a + (b - a) * weight_x;
  const Float4 bottom = c + (d - c) * weight_x;
  return (top + (bottom - top) * weight_y) * (1.0F / 255.0F);
}

}  // namespace stillpoint::synth
