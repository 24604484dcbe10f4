// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/depth_view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"

namespace stillpoint {

double median_depth(const DepthView& depth, const Eigen::Vector2d& pixel, int window_px) {
  STILLPOINT_CHECK(window_px <= kMaxDepthWindow_px);
  const int half = window_px / 2;
  const int column = static_cast<int>(std::lround(pixel.x()));
  const int row = static_cast<int>(std::lround(pixel.y()));
  std::array<std::uint16_t, kMaxDepthWindow_px * kMaxDepthWindow_px> valid;
  std::size_t count = 0;
  for (int v = std::max(row - half, 0); v <= std::min(row + half, depth.pixels.rows - 1); ++v) {
    for (int u = std::max(column - half, 0); u <= std::min(column + half, depth.pixels.cols - 1); ++u) {
      const std::uint16_t value = depth.pixels.at<std::uint16_t>(v, u);
      if (value > 0) valid[count++] = value;
    }
  }
  if (count == 0) return 0.0;
  const auto middle = valid.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(valid.begin(), middle, valid.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle / depth.units_per_m;
}

}  // namespace stillpoint
