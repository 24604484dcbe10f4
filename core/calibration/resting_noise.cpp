// SPDX-License-Identifier: BSD-3-Clause
#include "core/calibration/resting_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stillpoint {
namespace {

constexpr double kWindow_s = 1.0;
constexpr double kCluster_s = 0.05;
constexpr double kLongCluster_s = 0.25;
constexpr double kLargestGap_s = 0.02;
constexpr double kMostRatio = 4.0;  ///< of variances; white noise of 9 differences exceeds 2.2 in 5 %

/// Squared densities of both sensors, mean of the axes.
using Densities = Eigen::Array2d;

/// Of the samples over clusters of a duration.
Densities allan_densities(std::span<const ImuSample> samples, double interval_s, double cluster_s) {
  const auto size = static_cast<std::size_t>(std::max(1.0, std::round(cluster_s / interval_s)));
  Densities sum = Densities::Zero();
  Eigen::Vector3d last_gyro, last_accel;
  double count = 0.0;
  for (std::size_t first = 0; first + size <= samples.size(); first += size) {
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
    for (const ImuSample& sample : samples.subspan(first, size)) {
      gyro += sample.gyro_b / static_cast<double>(size);
      accel += sample.accel_b / static_cast<double>(size);
    }
    if (first > 0) {
      sum += Densities((gyro - last_gyro).squaredNorm(), (accel - last_accel).squaredNorm()) / 6.0;
      count += 1.0;
    }
    last_gyro = gyro;
    last_accel = accel;
  }
  return sum / count * static_cast<double>(size) * interval_s;
}

struct RestingWindow {
  Densities densities;
  double seconds = 0.0;
  Eigen::Vector3d mean_gyro = Eigen::Vector3d::Zero();
};

/// @param samples of a second, at least 20
std::optional<RestingWindow> resting_window(std::span<const ImuSample> samples) {
  const double interval_s =
      seconds_between(samples.front().t, samples.back().t) / static_cast<double>(samples.size() - 1);
  const Densities samples_only = allan_densities(samples, interval_s, interval_s),
                  clusters = allan_densities(samples, interval_s, kCluster_s),
                  long_clusters = allan_densities(samples, interval_s, kLongCluster_s);
  if ((clusters > kMostRatio * samples_only).any() || (samples_only > kMostRatio * clusters).any() ||
      (long_clusters > kMostRatio * clusters).any() || (clusters <= 0.0).any())
    return std::nullopt;
  RestingWindow window{.densities = clusters, .seconds = interval_s * static_cast<double>(samples.size())};
  for (const ImuSample& sample : samples)
    window.mean_gyro += sample.gyro_b / static_cast<double>(samples.size());
  return window;
}

std::vector<RestingWindow> resting_windows(std::span<const ImuSample> samples) {
  constexpr std::size_t kLeastSamples = 20;
  std::vector<RestingWindow> windows;
  std::size_t first = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i > first && seconds_between(samples[i - 1].t, samples[i].t) > kLargestGap_s) first = i;
    if (seconds_between(samples[first].t, samples[i].t) < kWindow_s) continue;
    const std::span<const ImuSample> window = samples.subspan(first, i - first);
    first = i;
    if (window.size() < kLeastSamples) continue;
    if (const auto resting = resting_window(window)) windows.push_back(*resting);
  }
  return windows;
}

}  // namespace

std::optional<RestingNoise> resting_noise(std::span<const ImuSample> samples) {
  std::vector<RestingWindow> windows = resting_windows(samples);
  if (windows.empty()) return std::nullopt;
  Densities least = windows.front().densities;
  for (const RestingWindow& window : windows) least = least.min(window.densities);
  std::erase_if(windows,
                [&](const RestingWindow& window) { return (window.densities > kMostRatio * least).any(); });
  if (windows.empty()) return std::nullopt;
  RestingNoise noise;
  Densities sum = Densities::Zero();
  for (const RestingWindow& window : windows) {
    noise.seconds += window.seconds;
    noise.gyro_bias += window.seconds * window.mean_gyro;
    sum += window.densities;
  }
  const Densities densities = (sum / static_cast<double>(windows.size())).sqrt();
  noise.gyro_noise = densities[0];
  noise.accel_noise = densities[1];
  noise.gyro_bias /= noise.seconds;
  noise.gyro_bias_sigma = noise.gyro_noise / std::sqrt(noise.seconds);
  // 2/3 of the differences are independent; the deviation is half of that of the variance.
  const double differences = 3.0 * (noise.seconds / kCluster_s - static_cast<double>(windows.size()));
  noise.relative_sigma = std::sqrt(0.75 / differences);
  return noise;
}

}  // namespace stillpoint
