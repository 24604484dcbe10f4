// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/semantic_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/types/detection.h"

namespace stillpoint {

double median_depth(const DepthView& depth, const Eigen::Vector2d& pixel, int window_px) {
  STILLPOINT_CHECK(window_px <= kMaxDepthWindow_px);
  const int half = window_px / 2;
  const int column = static_cast<int>(std::lround(pixel.x()));
  const int row = static_cast<int>(std::lround(pixel.y()));
  std::array<std::uint16_t, std::size_t{kMaxDepthWindow_px} * kMaxDepthWindow_px> valid;
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

namespace {

constexpr int kSamplesPerSide = 24;
constexpr double kBin_m = 0.1;           // bin width: thinner than a limb, wider than the sensor noise
constexpr std::size_t kBins = 150;       // up to 15 m, beyond the range of RGB-D cameras
constexpr double kCenterSigma = 0.6;     // of the Gaussian center weight, in half side lengths of the box
constexpr double kMinBinFraction = 0.1;  // of the maximum bin; bins below it end the interval

using Histogram = std::array<double, kBins>;

/// Depth histogram of the box, weighted by a Gaussian around its center.
Histogram depth_histogram(const DepthView& depth, const Box& box) {
  Histogram histogram{};
  const cv::Rect image(0, 0, depth.pixels.cols, depth.pixels.rows);
  for (int row = 0; row < kSamplesPerSide; ++row) {
    for (int column = 0; column < kSamplesPerSide; ++column) {
      const double x = (column + 0.5) / kSamplesPerSide, y = (row + 0.5) / kSamplesPerSide;
      const cv::Point pixel(cvRound(box.x_min + x * (box.x_max - box.x_min)),
                            cvRound(box.y_min + y * (box.y_max - box.y_min)));
      if (!image.contains(pixel)) continue;
      const double depth_m = depth.pixels.at<std::uint16_t>(pixel) / depth.units_per_m;
      const auto bin = static_cast<std::size_t>(depth_m / kBin_m);
      if (depth_m <= 0.0 || bin >= kBins) continue;
      const double rho_sq = (2.0 * x - 1.0) * (2.0 * x - 1.0) + (2.0 * y - 1.0) * (2.0 * y - 1.0);
      histogram[bin] += std::exp(-0.5 * rho_sq / (kCenterSigma * kCenterSigma));
    }
  }
  return histogram;
}

}  // namespace

DepthBand object_depth_band(const DepthView& depth, const Box& box, double extent_m) {
  const Histogram histogram = depth_histogram(depth, box);
  const auto mode = static_cast<std::size_t>(std::ranges::max_element(histogram) - histogram.begin());
  if (histogram[mode] <= 0.0) return {};
  const auto max_offset = static_cast<std::size_t>(std::ceil(extent_m / kBin_m));
  const auto is_filled = [&](std::size_t bin) { return histogram[bin] >= kMinBinFraction * histogram[mode]; };
  std::size_t first = mode, last = mode;
  while (first > 0 && mode - first < max_offset && is_filled(first - 1)) --first;
  while (last + 1 < kBins && last - mode < max_offset && is_filled(last + 1)) ++last;
  // One more bin on either side: sparsely filled bins may be an arm.
  return {.near_m = std::max(0.0, (static_cast<double>(first) - 1.0) * kBin_m),
          .far_m = (static_cast<double>(last) + 2.0) * kBin_m};
}

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
