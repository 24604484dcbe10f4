// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/window/pixel_noise.h"

#include <algorithm>
#include <cmath>

namespace stillpoint {
namespace {

constexpr std::size_t kMinObservations = 20;
constexpr double kSmoothing = 0.1;  // per window: time constant of about ten windows

}  // namespace

double ReprojectionErrorMonitor::median_px(const Window& window, double focal_px) {
  T_c_w_.clear();
  for (int frame = 0; frame <= window.newest(); ++frame) T_c_w_.push_back(window.T_w_c(frame).inverse());
  squared_.clear();
  for (const Landmark& landmark : window.landmarks) {
    if (!is_usable(landmark)) continue;
    const Eigen::Vector3d p_w = window.position(landmark);
    for (int frame = landmark.host + 1; frame <= landmark.last(); ++frame) {
      const Eigen::Vector3d p_c = T_c_w_[static_cast<std::size_t>(frame)] * p_w;
      const double squared = (p_c.hnormalized() - landmark.observation_in(frame).bearing).squaredNorm();
      if (std::isfinite(squared)) squared_.push_back(squared);
    }
  }
  if (squared_.size() < kMinObservations) return 0.0;
  const auto middle = squared_.begin() + static_cast<std::ptrdiff_t>(squared_.size() / 2);
  std::nth_element(squared_.begin(), middle, squared_.end());
  return focal_px * std::sqrt(*middle);
}

void PixelNoise::observe(double error_px, const BackendConfig& config) {
  if (!std::isfinite(error_px) || error_px <= 0.0 || config.reprojection_error_px <= 0.0) return;
  const double ratio = error_px / config.reprojection_error_px;
  const double factor =
      std::clamp(ratio * ratio, config.min_pixel_noise_factor, config.max_pixel_noise_factor);
  factor_ += kSmoothing * (factor - factor_);
}

BackendConfig PixelNoise::applied_to(BackendConfig config) const {
  config.pixel_sigma_px *= factor_;
  return config;
}

}  // namespace stillpoint
