// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/materials/texture.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/error.h"

namespace stillpoint::synth {
namespace {

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
  texels_.reserve((4 * rgb.total() + 6 * static_cast<std::size_t>(rgb.rows)) / 3 + 4);  // of all levels
  for (cv::Mat level = rgb;; level = halved(level)) {
    levels_.push_back({level.cols, level.rows, texels_.size()});
    for (int row = 0; row < level.rows; ++row) {
      for (int column = 0; column < level.cols; ++column)
        texels_.push_back(packed(level.at<cv::Vec3b>(row, column)));
      texels_.push_back(packed(level.at<cv::Vec3b>(row, 0)));
    }
    if (level.cols == 1 && level.rows == 1) break;
  }
}

}  // namespace stillpoint::synth
