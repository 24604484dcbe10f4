// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/track.h"

#include <algorithm>
#include <cstdint>

#include "core/types/frame.h"

namespace stillpoint {
namespace {

struct DepthRange {
  double min = 0.0;
  double max = 0.0;
};

/// Range of the raw depths measured in the 3x3 neighborhood of (row, column), where depth is measured.
DepthRange depth_range_3x3(const cv::Mat& depth, int row, int column) {
  const double center = depth.at<std::uint16_t>(row, column);
  DepthRange range{center, center};
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, depth.rows - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, depth.cols - 1); ++x) {
      const double raw = depth.at<std::uint16_t>(y, x);
      if (raw == 0.0) continue;
      range.min = std::min(range.min, raw);
      range.max = std::max(range.max, raw);
    }
  }
  return range;
}

}  // namespace

double sample_depth(const cv::Mat& depth, double depth_units_per_m, const Eigen::Vector2d& pixel,
                    double max_spread) {
  const double center = depth_at(depth, depth_units_per_m, pixel.x(), pixel.y());
  if (center <= 0.0 || max_spread <= 0.0) return center;
  const DepthRange range = depth_range_3x3(depth, cvRound(pixel.y()), cvRound(pixel.x()));
  const bool flat = range.max - range.min <= max_spread * center * depth_units_per_m;
  return flat ? center : 0.0;
}

}  // namespace stillpoint
