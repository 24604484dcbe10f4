// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/object_depth_band.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillpoint {
namespace {

constexpr int kSamples = 24;         // a side of the box
constexpr double kBin_m = 0.1;       // of the histogram: finer than a limb, coarser than the sensor's noise
constexpr std::size_t kBins = 150;   // to 15 m, beyond the reach of such cameras
constexpr double kMiddle = 0.6;      // spread of the weight around the middle, in half sides of the box
constexpr double kWellFilled = 0.1;  // of the fullest bin

using Histogram = std::array<double, kBins>;

/// Weight of what is measured at each depth; the middle of the box counts most.
Histogram depth_histogram(const DepthView& depth, const Box& box) {
  Histogram histogram{};
  const cv::Rect picture(0, 0, depth.pixels.cols, depth.pixels.rows);
  for (int row = 0; row < kSamples; ++row) {
    for (int column = 0; column < kSamples; ++column) {
      const double x = (column + 0.5) / kSamples, y = (row + 0.5) / kSamples;
      const cv::Point pixel(cvRound(box.x_min + x * (box.x_max - box.x_min)),
                            cvRound(box.y_min + y * (box.y_max - box.y_min)));
      if (!picture.contains(pixel)) continue;
      const double meters = depth.pixels.at<std::uint16_t>(pixel) / depth.units_per_m;
      const auto bin = static_cast<std::size_t>(meters / kBin_m);
      if (meters <= 0.0 || bin >= kBins) continue;
      const double off_middle = (2.0 * x - 1.0) * (2.0 * x - 1.0) + (2.0 * y - 1.0) * (2.0 * y - 1.0);
      histogram[bin] += std::exp(-0.5 * off_middle / (kMiddle * kMiddle));
    }
  }
  return histogram;
}

}  // namespace

DepthBand object_depth_band(const DepthView& depth, const Box& box, double extent_m) {
  const Histogram histogram = depth_histogram(depth, box);
  const auto fullest = static_cast<std::size_t>(std::ranges::max_element(histogram) - histogram.begin());
  if (histogram[fullest] <= 0.0) return {};
  const auto reach = static_cast<std::size_t>(std::ceil(extent_m / kBin_m));
  const auto filled = [&](std::size_t bin) { return histogram[bin] >= kWellFilled * histogram[fullest]; };
  std::size_t first = fullest, last = fullest;
  while (first > 0 && fullest - first < reach && filled(first - 1)) --first;
  while (last + 1 < kBins && last - fullest < reach && filled(last + 1)) ++last;
  // A bin more on either side: what is not well filled may be an arm.
  return {.near_m = std::max(0.0, (static_cast<double>(first) - 1.0) * kBin_m),
          .far_m = (static_cast<double>(last) + 2.0) * kBin_m};
}

}  // namespace stillpoint
