// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sensors/depth_sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint::synth {
namespace {

constexpr float kJump = 0.06F;  // relative difference of adjacent depths at an edge
constexpr std::uint64_t kLatticeOffset = 1ULL << 40;
constexpr std::uint64_t kDropoutOffset = 1ULL << 41;

/// Correlated noise of unit variance: bilinear interpolation of white noise on a lattice.
class SmoothNoise {
 public:
  SmoothNoise(int cell_px, std::uint64_t key) : cell_(cell_px), key_(key) {}

  [[nodiscard]] float at(int row, int column) const {
    const float x = static_cast<float>(column % cell_) / static_cast<float>(cell_);
    const float y = static_cast<float>(row % cell_) / static_cast<float>(cell_);
    const int left = column / cell_, top = row / cell_;
    const float upper = node(top, left) * (1.0F - x) + node(top, left + 1) * x;
    const float lower = node(top + 1, left) * (1.0F - x) + node(top + 1, left + 1) * x;
    const float variance = ((1.0F - x) * (1.0F - x) + x * x) * ((1.0F - y) * (1.0F - y) + y * y);
    return (upper * (1.0F - y) + lower * y) / std::sqrt(variance);
  }

 private:
  [[nodiscard]] float node(int row, int column) const {
    return normal_from_bits(
        mix_bits(key_ + kLatticeOffset + static_cast<std::uint64_t>(row * 65536 + column)));
  }
  int cell_;
  std::uint64_t key_;
};

bool differs(float a, float b) { return std::abs(a - b) > kJump * std::min(a, b); }

/// Whether a 4-neighbor has a different depth.
bool at_edge(const TrueDepth& image, int row, int column) {
  const int width = image.width, height = image.height;
  const auto depth = [&image](int y, int x) {
    return image.depth_m[static_cast<std::size_t>(y * image.width + x)];
  };
  const float here = depth(row, column);
  return (column > 0 && differs(depth(row, column - 1), here)) ||
         (column + 1 < width && differs(depth(row, column + 1), here)) ||
         (row > 0 && differs(depth(row - 1, column), here)) ||
         (row + 1 < height && differs(depth(row + 1, column), here));
}

/// Pixels of one row that are occluded in the second imager: a closer surface projects to the same column of
/// its image, at column - fb / z.
std::vector<bool> stereo_shadow(const float* depth_m, int width, double focal_baseline) {
  std::vector<bool> hidden(static_cast<std::size_t>(width));
  double nearest_column = std::numeric_limits<double>::infinity();
  for (int column = width - 1; column >= 0; --column) {
    if (depth_m[column] <= 0.0F) continue;
    const double column_in_second = column - focal_baseline / static_cast<double>(depth_m[column]);
    hidden[static_cast<std::size_t>(column)] = nearest_column <= column_in_second - 1.0;
    nearest_column = std::min(nearest_column, column_in_second);
  }
  return hidden;
}

std::uint16_t depth_reading(double depth_m, double noise, const DepthSensor& sensor) {
  double disparity = sensor.focal_baseline_px_m / depth_m;
  disparity += noise * sensor.noise_per_m * sensor.focal_baseline_px_m;
  if (sensor.disparity_step_px > 0.0) {
    disparity = std::round(disparity / sensor.disparity_step_px) * sensor.disparity_step_px;
  }
  if (disparity <= 0.0) return 0;
  const double z = sensor.focal_baseline_px_m / disparity;
  if (z < sensor.min_m || z > sensor.max_m) return 0;
  return static_cast<std::uint16_t>(std::min(std::lround(z * sensor.units_per_m), 65535L));
}

}  // namespace

cv::Mat simulate_depth(const TrueDepth& depth, const DepthSensor& sensor, std::uint64_t noise_key) {
  const auto& [depth_m, width, height] = depth;
  cv::Mat image = cv::Mat::zeros(height, width, CV_16UC1);
  const SmoothNoise smooth(sensor.correlation_px, noise_key);
  const auto smooth_weight = static_cast<float>(sensor.correlated_fraction);
  const float white_weight = std::sqrt(std::max(0.0F, 1.0F - smooth_weight * smooth_weight));
  std::size_t pixel = 0;
  for (int row = 0; row < height; ++row) {
    const std::vector<bool> hidden = stereo_shadow(
        depth_m.data() + row * width, width, sensor.edge_dropout > 0.0 ? sensor.focal_baseline_px_m : 0.0);
    for (int column = 0; column < width; ++column, ++pixel) {
      if (depth_m[pixel] <= 0.0F || hidden[static_cast<std::size_t>(column)]) continue;
      const std::uint64_t bits = mix_bits(noise_key + pixel);
      const double chance =
          static_cast<double>(mix_bits(noise_key + kDropoutOffset + pixel) >> 11) * 0x1.0p-53;
      if (chance < sensor.edge_dropout && at_edge(depth, row, column)) continue;
      const float noise = smooth_weight * smooth.at(row, column) + white_weight * normal_from_bits(bits);
      image.at<std::uint16_t>(row, column) =
          depth_reading(static_cast<double>(depth_m[pixel]), static_cast<double>(noise), sensor);
    }
  }
  return image;
}

}  // namespace stillpoint::synth
