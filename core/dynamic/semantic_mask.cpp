// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/semantic_mask.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/types/box_geometry.h"

namespace stillpoint {
namespace {

BoxDepths depths_on(const Box& box, const DepthView& depth, int window_px) {
  const auto at = [&](double u, double v) { return robust_depth(depth, {u, v}, window_px); };
  const Eigen::Vector2d center = center_of(box);
  return {.corners = {at(box.x_min, box.y_min), at(box.x_max, box.y_min), at(box.x_min, box.y_max),
                      at(box.x_max, box.y_max)},
          .center = at(center.x(), center.y())};
}

}  // namespace

double object_depth_threshold(const BoxDepths& depths, double epsilon_m) {
  STILLPOINT_CHECK(epsilon_m > 0.0);
  const double background = *std::max_element(depths.corners.begin(), depths.corners.end());
  const double object = depths.center;
  if (object > 0.0) {
    const bool clear_gap = background - object > epsilon_m;
    return clear_gap ? 0.5 * (background + object) : object + epsilon_m;
  }
  return background > 0.0 ? background : std::numeric_limits<double>::infinity();
}

double robust_depth(const DepthView& depth, const Eigen::Vector2d& pixel, int window_px) {
  const int half = window_px / 2;
  const int column = static_cast<int>(std::lround(pixel.x()));
  const int row = static_cast<int>(std::lround(pixel.y()));
  std::vector<std::uint16_t> measured;
  measured.reserve(static_cast<std::size_t>(window_px * window_px));
  for (int v = std::max(row - half, 0); v <= std::min(row + half, depth.pixels.rows - 1); ++v) {
    for (int u = std::max(column - half, 0); u <= std::min(column + half, depth.pixels.cols - 1); ++u) {
      const std::uint16_t value = depth.pixels.at<std::uint16_t>(v, u);
      if (value > 0) measured.push_back(value);
    }
  }
  if (measured.empty()) return 0.0;
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  return *middle / depth.units_per_m;
}

SemanticMask::SemanticMask(std::span<const Box> boxes, const DepthView& depth, cv::Size size,
                           const DynamicConfig& config) {
  if (config.mask == DynamicMask::kOff) return;
  const Box picture{.x_min = 0.0, .y_min = 0.0, .x_max = size.width - 1.0, .y_max = size.height - 1.0};
  for (const Box& detected : boxes) {
    const Box box = common_part(grown(detected, config.box_margin_px), picture);
    if (!has_area(detected) || !has_area(box)) continue;
    const double threshold =
        config.mask == DynamicMask::kWholeBox
            ? std::numeric_limits<double>::infinity()
            : object_depth_threshold(depths_on(box, depth, config.depth_window_px), config.epsilon_m);
    boxes_.push_back({.box = box, .threshold_m = threshold});
  }
}

double SemanticMask::threshold_at(const Eigen::Vector2d& pixel) const {
  double threshold = 0.0;
  for (const MaskedBox& masked : boxes_) {
    if (contains(masked.box, pixel)) threshold = std::max(threshold, masked.threshold_m);
  }
  return threshold;
}

}  // namespace stillpoint
