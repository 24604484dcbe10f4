// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/inertial_check.h"

#include <algorithm>
#include <cmath>

namespace stillpoint {
namespace {

constexpr double kMinInterval_s = 0.05;
constexpr double kHistory_s = 0.2;
constexpr int kAgreeingFrames = 6;
constexpr double kSettling_s = 0.5;
constexpr double kAfterGap_s = 0.5;
constexpr double kAfterChange_s = 0.3;
constexpr double kMinChangeSeverity = 0.4;

}  // namespace

std::optional<std::size_t> InertialCheck::pose_before(Timestamp t) const {
  for (std::size_t i = poses_.size(); i-- > 0;) {
    if (seconds_between(poses_[i].t, t) >= kMinInterval_s) return i;
  }
  return std::nullopt;
}

/// Of the error over the last two intervals.
std::optional<InertialError> InertialCheck::error_at(const VisualPose& pose, const NavState& state,
                                                     const Eigen::Vector3d& gravity_w, ImuBuffer& imu) {
  const std::optional<std::size_t> middle = pose_before(pose.t);
  if (!middle) return std::nullopt;
  const VisualPose& B = poses_[*middle];
  const std::optional<std::size_t> first = pose_before(B.t);
  if (!first) return std::nullopt;
  return inertial_error({.A = poses_[*first], .B = B, .C = pose}, state, gravity_w, imu);
}

bool InertialCheck::update(const VisualPose& pose, const NavState& state, const Eigen::Vector3d& gravity_w,
                           ImuBuffer& imu) {
  if (resume_at_ && pose.t < *resume_at_) return consistent_;
  const std::optional<InertialError> error = error_at(pose, state, gravity_w, imu);
  std::erase_if(poses_, [&](const VisualPose& old) { return seconds_between(old.t, pose.t) > kHistory_s; });
  poses_.push_back(pose);
  if (!error) return consistent_;
  const double severity = error->severity();
  agreeing_frames_ = severity < 0.5 ? agreeing_frames_ + 1 : 0;
  if (severity > kMinChangeSeverity && error->is_explained()) changed_at_ = pose.t;
  const bool changed = changed_at_ && seconds_between(*changed_at_, pose.t) < kAfterChange_s;
  const bool was_missing = missing_at_ && seconds_between(*missing_at_, pose.t) < kAfterGap_s;
  const bool has_reason = changed || was_missing || !std::isfinite(severity);
  if (!(severity <= 1.0) && has_reason) consistent_ = false;
  if (agreeing_frames_ >= kAgreeingFrames && !held_) consistent_ = true;
  return consistent_;
}

void InertialCheck::interrupt(Timestamp t) {
  poses_.clear();
  resume_at_ = after(t, kSettling_s);
}

void InertialCheck::contradict() {
  consistent_ = false;
  agreeing_frames_ = 0;
}

void InertialCheck::reset() {
  resume_at_.reset();
  changed_at_.reset();
  poses_.clear();
  held_ = false;
  consistent_ = true;
  agreeing_frames_ = 0;
}

}  // namespace stillpoint
