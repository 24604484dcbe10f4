// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/window/pixel_noise.h"

#include <cmath>
#include <numbers>

namespace stillpoint {
namespace {

constexpr std::size_t kMinObservations = 20;
constexpr double kSmoothing = 0.1;  // per window: time constant of about ten windows
// K. Geometric means of the ATE with K = 6 and 15 [mm], by the visual pose of before ddcbf53: recorded motion
// and IMU with the densities of data sheets (EuRoC V1_03 from two starts, TUM-VI room1, room3; rendered
// images) 5.0, 5.7; real images (7-Scenes kitchen, visual odometry, c = 3, three starts) 24.8, 20.9, and with
// K = 6 and c = 4 21.5.
constexpr double kObservationsPerTrack = 6.0;
// A tenth of a pixel is the best that alignment of patches reaches; 9 px is 1 deg at a focal length of 500
// px.
constexpr double kMinSigma_px = 0.09;
constexpr double kMaxSigma_px = 9.0;

// Of D. On 7-Scenes kitchen the correlation of changes is 0.5 below 100 px (focal length 528 px), 0.3 below
// 200 px and 0 beyond.
constexpr double kNeighborDistance = 0.4;
constexpr double kClip = 1.5;  // of the standard deviation

/// Of one component of a two-dimensional normal vector with these squared norms.
double variance(std::vector<double>& squared_norms) {
  const auto middle = squared_norms.begin() + static_cast<std::ptrdiff_t>(squared_norms.size() / 2);
  std::nth_element(squared_norms.begin(), middle, squared_norms.end());
  return *middle / (2.0 * std::numbers::ln2);
}

}  // namespace

std::optional<ReprojectionVariance> ReprojectionErrorMonitor::measure(const Window& window, double focal_px) {
  T_c_w_.clear();
  for (int frame = 0; frame <= window.newest(); ++frame) T_c_w_.push_back(window.T_w_c(frame).inverse());
  squared_.clear();
  changes_.clear();
  newest_.clear();
  for (const Landmark& landmark : window.landmarks) {
    if (!is_usable(landmark)) continue;
    const Eigen::Vector3d p_w = window.position(landmark);
    std::optional<Eigen::Vector2d> previous;
    for (int frame = landmark.host + 1; frame <= landmark.last(); ++frame) {
      const Eigen::Vector3d p_c = T_c_w_[static_cast<std::size_t>(frame)] * p_w;
      const Eigen::Vector2d error = p_c.hnormalized() - landmark.observation_in(frame).bearing;
      if (!error.allFinite()) continue;
      squared_.push_back(error.squaredNorm());
      if (previous) changes_.push_back((error - *previous).squaredNorm());
      if (previous && frame == window.newest())
        newest_.push_back({landmark.observation_in(frame).bearing, error - *previous});
      previous = error;
    }
  }
  if (squared_.size() < kMinObservations || changes_.size() < kMinObservations) return std::nullopt;
  const double px2 = focal_px * focal_px;
  const double white_px2 = px2 * variance(changes_);
  const double correlated_px2 = std::max(0.0, px2 * variance(squared_) - white_px2);
  return ReprojectionVariance{
      .white_px2 = white_px2, .correlated_px2 = correlated_px2, .design_effect = design_effect()};
}

double ReprojectionErrorMonitor::design_effect() {
  if (newest_.size() < kMinObservations) return 1.0;
  squared_.clear();
  for (const Change& feature : newest_) squared_.push_back(feature.error.squaredNorm());
  const double clip = kClip * std::sqrt(variance(squared_));
  if (clip <= 0.0) return 1.0;
  double total = 0.0;
  double common = 0.0;
  for (std::size_t a = 0; a < newest_.size(); ++a) {
    newest_[a].error /= std::max(clip, newest_[a].error.norm());
    total += newest_[a].error.squaredNorm();
    for (std::size_t b = 0; b < a; ++b) {
      const double distance = (newest_[a].bearing - newest_[b].bearing).norm();
      if (distance < kNeighborDistance) common += newest_[a].error.dot(newest_[b].error);
    }
  }
  return 1.0 + 2.0 * common / total;
}

void PixelNoise::observe(const ReprojectionVariance& variance) {
  const auto follow = [](double observed_px, double& sigma_px) {
    sigma_px += kSmoothing * (std::clamp(observed_px, kMinSigma_px, kMaxSigma_px) - sigma_px);
  };
  follow(scale_ * std::sqrt(variance.white_px2 + kObservationsPerTrack * variance.correlated_px2), sigma_px_);
  follow(std::sqrt(variance.white_px2), white_px_);
  design_effect_ += kSmoothing * (variance.design_effect - design_effect_);
}

BackendConfig PixelNoise::applied_to(BackendConfig config) const {
  const double root = std::sqrt(std::max(1.0, design_effect_));
  config.pixel_sigma_px = root * sigma_px_;
  config.cauchy_scale /= root;
  return config;
}

}  // namespace stillpoint
