// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/trusted_map.h"

#include <algorithm>
#include <utility>

#include "core/backend/vision/vision_assessment.h"
#include "core/config/monitor_config.h"

namespace stillpoint {
namespace {

constexpr std::size_t kReservedPoints = 1024;  // so that updates allocate no memory

}  // namespace

TrustedMap::TrustedMap() {
  for (Version* version : {&newest_, &candidate_, &earlier_}) version->points.reserve(kReservedPoints);
}

void TrustedMap::update(const Window& window, const Matrix6& covariance) {
  newest_.t = window.frames.back().state.t;
  newest_.T_w_b = {window.frames.back().state.T_w_b, covariance};
  newest_.points.clear();
  for (const Landmark& landmark : window.landmarks) {
    if (is_usable(landmark)) newest_.points.push_back({landmark.id, window.position(landmark)});
  }
  if (!candidate_.points.empty() &&
      seconds_between(candidate_.t, newest_.t) < kMonitor.tracking.version_age_s)
    return;
  std::swap(earlier_, candidate_);
  candidate_ = newest_;
}

void TrustedMap::discard_newest() {
  newest_ = earlier_;
  candidate_ = earlier_;
}

void TrustedMap::clear() {
  for (Version* version : {&newest_, &candidate_, &earlier_}) version->points.clear();
}

std::optional<UncertainPose> TrustedMap::locate(const TrackedFrame& frame, const Pose& prediction,
                                                CameraPoseOptions options, double bearing_sigma) {
  observations_.clear();
  auto point = newest_.points.begin();
  for (const TrackedFeature& feature : frame.features) {
    while (point != newest_.points.end() && point->id < feature.id) ++point;
    if (point == newest_.points.end()) break;
    if (point->id == feature.id) observations_.push_back({point->p_w, feature.bearing});
  }
  const auto matched = static_cast<int>(observations_.size());
  if (matched < kMonitor.tracking.min_map_features) return std::nullopt;
  options.min_inliers =
      std::max(options.min_inliers, static_cast<int>(kMonitor.tracking.min_map_inlier_ratio * matched));
  const std::optional<CameraPose> found = estimate_camera_pose(observations_, prediction, options);
  if (!found) return std::nullopt;
  return with_covariance(observations_, found->T_w_c, bearing_sigma, options.inlier_threshold);
}

}  // namespace stillpoint
