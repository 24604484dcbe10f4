// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/depth_scale.h"

#include <algorithm>
#include <cmath>

namespace stillpoint {
namespace {

constexpr std::size_t kMinLandmarks = 15;
constexpr double kAgreeing = 0.02;
constexpr double kMinDepth = 0.05;  // [m]

}  // namespace

std::optional<double> DepthScale::of_newest(const Window& window) {
  ratios_.clear();
  const Pose T_c_w = window.T_w_c(window.newest()).inverse();
  for (const Landmark& landmark : window.landmarks) {
    if (!is_usable(landmark) || landmark.last() != window.newest()) continue;
    const double measured = landmark.observations.back().depth;
    const double known = (T_c_w * window.position(landmark)).z();
    if (measured > 0.0 && known > kMinDepth) ratios_.push_back(measured / (window.depth_scale * known));
  }
  if (ratios_.size() < kMinLandmarks) return std::nullopt;
  const auto middle = ratios_.begin() + static_cast<std::ptrdiff_t>(ratios_.size() / 2);
  std::ranges::nth_element(ratios_, middle);
  const double median = *middle;
  const auto agreeing = std::ranges::count_if(
      ratios_, [median](double ratio) { return std::abs(ratio - median) <= kAgreeing * median; });
  if (2 * agreeing < static_cast<std::ptrdiff_t>(ratios_.size())) return std::nullopt;
  return median;
}

}  // namespace stillpoint
