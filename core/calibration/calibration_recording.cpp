// SPDX-License-Identifier: BSD-3-Clause
#include "core/calibration/calibration_recording.h"

#include <algorithm>
#include <utility>

namespace stillpoint {
namespace {

const TrackedFeature* find_feature(const std::vector<TrackedFeature>& features, std::int64_t id) {
  const auto found = std::ranges::lower_bound(features, id, {}, &TrackedFeature::id);
  return found == features.end() || found->id != id ? nullptr : &*found;
}

/// With the velocity from the frame before, if it has the feature.
CalibrationFeature feature_of(const TrackedFeature& feature, const TrackedFrame& before, Timestamp t) {
  CalibrationFeature result{.track = feature.id, .pixel = feature.pixel, .depth_m = feature.depth};
  const TrackedFeature* const earlier = find_feature(before.features, feature.id);
  if (earlier != nullptr)
    result.velocity_px = (feature.pixel - earlier->pixel) / seconds_between(before.t, t);
  return result;
}

}  // namespace

/// Central differences for features that the next frame has as well.
void CalibrationCollector::complete_velocities(const TrackedFrame& next) {
  CalibrationKeyframe& keyframe = sections_.back().keyframes.back();
  const double forward_s = seconds_between(keyframe.state.t, next.t);
  const double backward_s = seconds_between(before_keyframe_, keyframe.state.t);
  for (CalibrationFeature& feature : keyframe.features) {
    const TrackedFeature* const later = find_feature(next.features, feature.track);
    if (later == nullptr) continue;
    const Eigen::Vector2d moved = later->pixel - feature.pixel;
    const bool has_backward = !feature.velocity_px.isZero(0.0);
    feature.velocity_px =
        has_backward ? Eigen::Vector2d((moved + feature.velocity_px * backward_s) / (forward_s + backward_s))
                     : Eigen::Vector2d(moved / forward_s);
  }
}

void CalibrationCollector::add(const TrackedFrame& frame, std::span<const DynamicLabel> labels,
                               const OdometryUpdate& update) {
  for (const DynamicLabel& label : labels) {
    if (label.label != LabelClass::kStable) dynamic_.insert(label.id);
  }
  if (frame.repeated) return;
  if (is_pending_) complete_velocities(frame);
  is_pending_ = false;
  const bool is_new_section = update.segment != segment_ || sections_.empty();
  const bool is_due = is_new_section || seconds_between(sections_.back().keyframes.back().state.t, frame.t) >=
                                            interval_s_ - 1e-3;
  if (is_located(update.status) && !labels.empty() && is_due) {
    if (is_new_section) sections_.emplace_back();
    segment_ = update.segment;
    CalibrationSection& section = sections_.back();
    section.gravity_w = update.q_level_w.conjugate() * -Eigen::Vector3d::UnitZ();
    section.keyframes.push_back({.state = update.state,
                                 .T_w_c = update.T_w_c,
                                 .frame = frame.id,
                                 .depth = frame.depth,
                                 .features = {}});
    section.keyframes.back().state.t = frame.t;
    for (const TrackedFeature& feature : frame.features)
      section.keyframes.back().features.push_back(feature_of(feature, before_, frame.t));
    before_keyframe_ = before_.t;
    is_pending_ = true;
  }
  before_.t = frame.t;
  before_.features = frame.features;
}

std::vector<CalibrationSection> CalibrationCollector::finish() {
  for (CalibrationSection& section : sections_) {
    for (CalibrationKeyframe& keyframe : section.keyframes)
      std::erase_if(keyframe.features,
                    [&](const CalibrationFeature& feature) { return dynamic_.contains(feature.track); });
  }
  return std::move(sections_);
}

}  // namespace stillpoint
