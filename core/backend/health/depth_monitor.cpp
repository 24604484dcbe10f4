// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/depth_monitor.h"

#include <algorithm>
#include <cmath>

#include "core/config/monitor_config.h"

namespace stillpoint {
std::optional<double> DepthScale::of_newest(const Window& window) {
  ratios_.clear();
  const Pose T_c_w = window.T_w_c(window.newest()).inverse();
  for (const Landmark& landmark : window.landmarks) {
    if (!is_usable(landmark) || landmark.last() != window.newest()) continue;
    const double measured = landmark.observations.back().depth;
    const double known = (T_c_w * window.position(landmark)).z();
    if (measured > 0.0 && known > kMonitor.vision.min_depth_m)
      ratios_.push_back(measured / (window.depth_scale * known));
  }
  if (static_cast<int>(ratios_.size()) < kMonitor.depth_scale.min_landmarks) return std::nullopt;
  const auto middle = ratios_.begin() + static_cast<std::ptrdiff_t>(ratios_.size() / 2);
  std::ranges::nth_element(ratios_, middle);
  const double median = *middle;
  const auto agreeing = std::ranges::count_if(ratios_, [median](double ratio) {
    return std::abs(ratio - median) <= kMonitor.depth_scale.agreeing * median;
  });
  if (2 * agreeing < static_cast<std::ptrdiff_t>(ratios_.size())) return std::nullopt;
  return median;
}

bool DepthMonitor::knows_scale(const std::optional<StateCovariance>& covariance, const Window& window) const {
  return !window.agrees_with_rig.depth_scale ||
         (covariance && kMonitor.depth_scale.known_sigmas * std::sqrt(covariance->depth_scale) < max_error_);
}

void DepthMonitor::update(const std::optional<StateCovariance>& covariance, Window& window) {
  if (max_error_ <= 0.0 || !knows_scale(covariance, window)) return;
  const std::optional<double> scale = scale_.of_newest(window);
  const Timestamp t = window.frames.back().state.t;
  if (scale && std::abs(*scale - 1.0) <= kMonitor.depth_scale.agreeing_part * max_error_)
    rejected_since_.reset();
  if (scale && std::abs(*scale - 1.0) > max_error_ && !rejected_since_) rejected_since_ = t;
  if (!rejected_since_ || seconds_between(*rejected_since_, t) > kMonitor.depth_scale.max_rejection_s) return;
  for (Landmark& landmark : window.landmarks) {
    if (landmark.last() == window.newest()) landmark.observations.back().depth = 0.0;
  }
}

}  // namespace stillpoint
