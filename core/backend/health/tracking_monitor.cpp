// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/tracking_monitor.h"

#include <cmath>

#include "core/config/monitor_config.h"

namespace stillpoint {
namespace {

using enum OdometryStatus;

bool is_plausible(const Pose& predicted, const Pose& found, double seconds) {
  return (predicted.p - found.p).norm() <=
             kMonitor.tracking.gate_m + kMonitor.tracking.gate_rate_m * seconds &&
         predicted.q.angularDistance(found.q) <=
             kMonitor.tracking.gate_rad + kMonitor.tracking.gate_rate_rad * seconds;
}

/// Along its least certain direction [m].
double position_sigma(const FrameEvidence& evidence) {
  return largest_sigma(evidence.covariance.topLeftCorner<3, 3>());
}

}  // namespace

std::optional<UncertainPose> TrackingMonitor::relocalize(const TrackedFrame& frame, const Pose& T_w_c) {
  relocated_ = false;
  if (map_.empty() || !(status_ == kDeadReckoning || awaits_map_)) return std::nullopt;
  const CameraPoseOptions options{.inlier_threshold = options_.inlier_threshold,
                                  .seed = options_.seed + static_cast<std::uint32_t>(frame.id)};
  std::optional<UncertainPose> found = map_.locate(frame, T_w_c, options, options_.bearing_sigma);
  if (!found || !is_plausible(T_w_c, found->T_w_f, seconds_between(located_at_, frame.t)))
    return std::nullopt;
  return found;
}

/// Located by vision, in the world of the segment.
TrackingMonitor::Decision TrackingMonitor::decide_located(const FrameEvidence& evidence) const {
  if (relocated_ || status_ == kLost) return {kRelocated, StatusReason::kMapMatched};
  if (options_.uses_imu && !evidence.inertial) return {kDegraded, StatusReason::kNoInertialStart};
  if (evidence.imu_defect != StatusReason::kNone) return {kDegraded, evidence.imu_defect};
  if (evidence.contradiction) return {kDegraded, StatusReason::kImuInconsistent};
  if (evidence.vision.has_few_features()) return {kDegraded, StatusReason::kFewFeatures};
  if (evidence.vision.has_weak_geometry()) return {kDegraded, StatusReason::kWeakGeometry};
  return {kTracking, StatusReason::kNone};
}

bool TrackingMonitor::is_too_uncertain(const FrameEvidence& evidence) const {
  const double grown = std::pow(position_sigma(evidence), 2) - std::pow(located_sigma_m_, 2);
  return seconds_between(located_at_, evidence.t) > options_.max_dead_reckoning_s ||
         grown > std::pow(kMonitor.tracking.max_dead_reckoning_sigma_m, 2);
}

/// Whether constant velocity since vision last located the camera replaces an image that is missing.
bool TrackingMonitor::bridges(const FrameEvidence& evidence) const {
  return evidence.bridged && is_located(status_) &&
         seconds_between(located_at_, evidence.t) <= kMonitor.tracking.max_repetition_s;
}

TrackingMonitor::Decision TrackingMonitor::decide(const FrameEvidence& evidence) const {
  if (status_ == kInitializing) {
    if (!evidence.has_start || !evidence.located) return {kInitializing, StatusReason::kNone};
    return {kTracking, StatusReason::kNone};
  }
  if (evidence.failure != StatusReason::kNone) return {kLost, evidence.failure};
  if (relocated_) return {kRelocated, StatusReason::kMapMatched};
  if (awaits_map_) return {kLost, reason_};
  if (evidence.located) return decide_located(evidence);
  if (!evidence.inertial && bridges(evidence)) return {kDegraded, StatusReason::kRepeatedImage};
  if (!evidence.inertial) return {kLost, StatusReason::kFewFeatures};
  if (evidence.imu_defect != StatusReason::kNone) return {kLost, evidence.imu_defect};
  if (is_too_uncertain(evidence)) return {kLost, StatusReason::kUncertain};
  return {kDeadReckoning, StatusReason::kFewFeatures};
}

/// Whether the view has returned for some time without a pose from the map.
bool TrackingMonitor::patience_is_over(const FrameEvidence& evidence) {
  if (status_ != kLost) {
    visible_since_.reset();
    visible_frames_ = 0;
  } else if (evidence.features >= kMonitor.tracking.visible_features) {
    if (!visible_since_) visible_since_ = evidence.t;
    ++visible_frames_;
  }
  return visible_since_ && visible_frames_ >= kMonitor.tracking.min_relocalization_frames &&
         seconds_between(*visible_since_, evidence.t) > options_.max_relocalization_s;
}

void TrackingMonitor::begin_segment() {
  map_.clear();
  visible_since_.reset();
  visible_frames_ = 0;
  awaits_map_ = false;
  ++segment_;
  status_ = kInitializing;
  reason_ = StatusReason::kNone;
}

bool TrackingMonitor::update(const FrameEvidence& evidence, const Window& window) {
  const bool diverged = evidence.failure != StatusReason::kNone && status_ != kInitializing;
  const bool reckoned = status_ == kDeadReckoning;
  const Decision decision = decide(evidence);
  status_ = decision.status;
  reason_ = decision.reason;
  relocated_ = false;
  if (is_located(status_) && reason_ != StatusReason::kRepeatedImage) {
    located_at_ = evidence.t;
    located_sigma_m_ = position_sigma(evidence);
    awaits_map_ = false;
  }
  if (status_ == kTracking) map_.update(window, evidence.covariance);
  if (diverged) map_.discard_newest();
  // Frames without features end the landmarks of the window: after them only the map can locate the camera.
  const bool reckoning_ends =
      status_ == kLost && !diverged && !awaits_map_ && (reckoned || reason_ == StatusReason::kUncertain);
  awaits_map_ = awaits_map_ || diverged || reckoning_ends;
  const bool new_segment = patience_is_over(evidence);
  if (new_segment) begin_segment();
  return new_segment || reckoning_ends;
}

}  // namespace stillpoint
