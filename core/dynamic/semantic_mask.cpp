// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/semantic_mask.h"

#include <algorithm>
#include <limits>

#include "core/base/error.h"
#include "core/dynamic/object_depth_band.h"
#include "core/types/box_geometry.h"

namespace stillpoint {
namespace {

BoxDepths sample_depths(const Box& box, const DepthView& depth, int window_px) {
  const auto depth_at = [&](double u, double v) { return median_depth(depth, {u, v}, window_px); };
  const Eigen::Vector2d center = center_of(box);
  return {.corners = {depth_at(box.x_min, box.y_min), depth_at(box.x_max, box.y_min),
                      depth_at(box.x_min, box.y_max), depth_at(box.x_max, box.y_max)},
          .center = depth_at(center.x(), center.y())};
}

/// @param detected without the margin
/// @param box      with the margin, clipped to the image
DepthBand depth_range(const Box& detected, const Box& box, const DepthView& depth,
                      const DynamicConfig& config) {
  if (config.mask == DynamicMask::kWholeBox) return {};
  if (config.mask == DynamicMask::kDepthBand) return object_depth_band(depth, detected, config.epsilon_m);
  return {.far_m =
              object_depth_threshold(sample_depths(box, depth, config.depth_window_px), config.epsilon_m)};
}

}  // namespace

double object_depth_threshold(const BoxDepths& depths, double epsilon_m) {
  STILLPOINT_CHECK(epsilon_m > 0.0);
  const double d_max = *std::max_element(depths.corners.begin(), depths.corners.end());
  const double d_c = depths.center;
  if (d_c > 0.0) {
    const bool before_background = d_max - d_c > epsilon_m;
    return before_background ? 0.5 * (d_max + d_c) : d_c + epsilon_m;
  }
  return d_max > 0.0 ? d_max : std::numeric_limits<double>::infinity();
}

void SemanticMask::assign(std::span<const Box> boxes, const DepthView& depth, cv::Size size,
                          const DynamicConfig& config) {
  boxes_.clear();
  if (config.mask == DynamicMask::kOff) return;
  const Box image{.x_min = 0.0, .y_min = 0.0, .x_max = size.width - 1.0, .y_max = size.height - 1.0};
  for (const Box& detected : boxes) {
    const Box box = intersection(expanded(detected, config.box_margin_px), image);
    if (!has_area(detected) || !has_area(box)) continue;
    const DepthBand band = depth_range(detected, box, depth, config);
    boxes_.push_back({.box = box, .threshold_m = band.far_m, .near_m = band.near_m});
  }
}

double SemanticMask::threshold_at(const Eigen::Vector2d& pixel) const {
  double threshold = 0.0;
  for (const MaskedBox& masked : boxes_) {
    if (contains(masked.box, pixel)) threshold = std::max(threshold, masked.threshold_m);
  }
  return threshold;
}

bool SemanticMask::covers(const Eigen::Vector2d& pixel, double depth_m) const {
  return std::ranges::any_of(boxes_, [&](const MaskedBox& masked) {
    return contains(masked.box, pixel) && depth_m >= masked.near_m && depth_m < masked.threshold_m;
  });
}

}  // namespace stillpoint
