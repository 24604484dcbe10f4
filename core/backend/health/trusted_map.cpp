// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/trusted_map.h"

#include <algorithm>
#include <utility>

#include "core/backend/health/vision_assessment.h"

namespace stillpoint {
namespace {

constexpr double kVersionAge_s = 0.5;
constexpr int kMinFeatures = 12;
constexpr std::size_t kReservedPoints = 1024;  // so that updates allocate no memory
constexpr double kMinInlierRatio = 0.5;

}  // namespace

TrustedMap::TrustedMap() {
  for (Version* version : {&newest_, &candidate_, &earlier_}) version->points.reserve(kReservedPoints);
}

void TrustedMap::update(const Window& window) {
  newest_.t = window.frames.back().state.t;
  newest_.points.clear();
  for (const Landmark& landmark : window.landmarks) {
    if (is_usable(landmark)) newest_.points.push_back({landmark.id, window.position(landmark)});
  }
  if (!candidate_.points.empty() && seconds_between(candidate_.t, newest_.t) < kVersionAge_s) return;
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
  if (matched < kMinFeatures) return std::nullopt;
  options.min_inliers = std::max(options.min_inliers, static_cast<int>(kMinInlierRatio * matched));
  const std::optional<CameraPose> found = estimate_camera_pose(observations_, prediction, options);
  if (!found) return std::nullopt;
  return with_covariance(observations_, found->T_w_c, bearing_sigma, options.inlier_threshold);
}

}  // namespace stillpoint
