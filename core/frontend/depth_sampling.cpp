// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/depth_sampling.h"

#include <algorithm>
#include <cstdint>

#include "core/types/frame.h"

namespace stillpoint {
namespace {

struct Extent {
  double nearest = 0.0;
  double farthest = 0.0;
};

/// Raw depths measured in the 3x3 pixels around (row, column), which is measured itself.
Extent extent_around(const cv::Mat& depth, int row, int column) {
  const double center = depth.at<std::uint16_t>(row, column);
  Extent extent{center, center};
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, depth.rows - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, depth.cols - 1); ++x) {
      const double raw = depth.at<std::uint16_t>(y, x);
      if (raw == 0.0) continue;
      extent.nearest = std::min(extent.nearest, raw);
      extent.farthest = std::max(extent.farthest, raw);
    }
  }
  return extent;
}

}  // namespace

double sample_depth(const cv::Mat& depth, double depth_units_per_m, const Eigen::Vector2d& pixel,
                    double max_spread) {
  const double center = depth_at(depth, depth_units_per_m, pixel.x(), pixel.y());
  if (center <= 0.0 || max_spread <= 0.0) return center;
  const Extent extent = extent_around(depth, cvRound(pixel.y()), cvRound(pixel.x()));
  const bool flat = extent.farthest - extent.nearest <= max_spread * center * depth_units_per_m;
  return flat ? center : 0.0;
}

}  // namespace stillpoint
