// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/depth_monitor.h"

#include <algorithm>
#include <cmath>

#include "core/config/monitor_config.h"

namespace stillpoint {
namespace {

/// Before a jump of the scale: an inertial scale that differs from that of the depth pulls the landmarks away
/// from it within the first second, but not from one frame to the next.
constexpr double kMinAgreement_s = 1.0;

}  // namespace

std::optional<double> DepthScale::of_newest(const Window& window) {
  ratios_.clear();
  const Pose T_c_w = window.T_w_c(window.newest()).inverse();
  const bool is_predicted = window.has_inertial_prediction();
  for (const Landmark& landmark : window.landmarks) {
    if (!is_usable(landmark) || landmark.last() != window.newest()) continue;
    const Observation& observation = landmark.observations.back();
    const Eigen::Vector3d p_c = T_c_w * window.position(landmark);
    if (!(observation.depth > 0.0 && p_c.z() > kMonitor.vision.min_depth_m)) continue;
    if (is_predicted && (p_c.hnormalized() - observation.bearing).norm() > inlier_) continue;
    ratios_.push_back(observation.depth / (window.depth_scale * p_c.z()));
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

/// Whether a scale that has agreed for some time, by the unit of the rig, does so no more.
bool DepthMonitor::has_jumped(double error, Timestamp t) {
  const bool differs = error > max_error_;
  const bool jumped = differs && agrees_since_ && seconds_between(*agrees_since_, t) >= kMinAgreement_s;
  if (error > kMonitor.depth_scale.agreeing_part * max_error_) {
    agrees_since_.reset();
  } else if (!agrees_since_) {
    agrees_since_ = t;
  }
  return jumped;
}

void DepthMonitor::update(const std::optional<StateCovariance>& covariance, Window& window) {
  if (max_error_ <= 0.0) return;
  const bool is_known = knows_scale(covariance, window);
  const std::optional<double> scale = scale_.of_newest(window);
  const Timestamp t = window.frames.back().state.t;
  if (scale) {
    const double error = std::abs(*scale - 1.0);
    const bool jumped = has_jumped(error, t);
    if (error <= kMonitor.depth_scale.agreeing_part * max_error_) rejected_since_.reset();
    if (error > max_error_ && !rejected_since_ && (is_known || jumped)) {
      rejected_since_ = t;
      rejects_jump_ = jumped;
    }
  }
  if (!rejected_since_ || seconds_between(*rejected_since_, t) > kMonitor.depth_scale.max_rejection_s) return;
  if (!is_known && !rejects_jump_) return;
  for (Landmark& landmark : window.landmarks) {
    if (landmark.last() == window.newest()) landmark.observations.back().depth = 0.0;
  }
}

}  // namespace stillpoint
