// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/object_depth_band.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillpoint {
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

}  // namespace stillpoint
