// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/klt/pyramid_downsampling.h"

#include <cstddef>
#include <cstring>

namespace stillpoint {
namespace {

constexpr int kReach = 2;  // half width of the filter

}  // namespace

void reflect_border(cv::Mat image, int border_px) {
  const int width = image.cols;
  const auto stride = static_cast<std::ptrdiff_t>(image.step[0]);
  for (int y = 0; y < image.rows; ++y) {
    std::uint8_t* const row = image.ptr<std::uint8_t>(y);
    for (int k = 1; k <= border_px; ++k) {
      row[-k] = row[k];
      row[width - 1 + k] = row[width - 1 - k];
    }
  }
  std::uint8_t* const first = image.data - border_px;
  std::uint8_t* const last = first + (image.rows - 1) * stride;
  for (int k = 1; k <= border_px; ++k) {
    std::memcpy(first - k * stride, first + k * stride, static_cast<std::size_t>(width + 2 * border_px));
    std::memcpy(last + k * stride, last - k * stride, static_cast<std::size_t>(width + 2 * border_px));
  }
}

void pyr_down(const cv::Mat& from, cv::Mat to, std::vector<std::uint16_t>& column_sums) {
  const auto stride = static_cast<std::ptrdiff_t>(from.step[0]);
  const std::ptrdiff_t columns = from.cols + 2 * kReach;
  column_sums.resize(static_cast<std::size_t>(columns + 1));
  for (int y = 0; y < to.rows; ++y) {
    const std::uint8_t* const middle = from.data + 2 * y * stride - kReach;
    for (std::ptrdiff_t x = 0; x < columns; ++x) {  // at most 16 * 255
      column_sums[static_cast<std::size_t>(x)] =
          static_cast<std::uint16_t>(middle[x - 2 * stride] + middle[x + 2 * stride] +
                                     4 * (middle[x - stride] + middle[x + stride]) + 6 * middle[x]);
    }
    std::uint8_t* const row = to.ptr<std::uint8_t>(y);
    const std::uint16_t* sum = column_sums.data();
    for (int x = 0; x < to.cols; ++x, sum += 2) {  // at most 256 * 255, and rounded
      row[x] = static_cast<std::uint8_t>((sum[0] + sum[4] + 4 * (sum[1] + sum[3]) + 6 * sum[2] + 128) >> 8);
    }
  }
}

}  // namespace stillpoint
