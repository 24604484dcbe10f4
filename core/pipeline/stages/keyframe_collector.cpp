// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/stages/keyframe_collector.h"

#include <algorithm>
#include <numbers>
#include <utility>

namespace stillpoint {
namespace {

/// Rotation since the last keyframe that makes a keyframe, with `loop.min_translation_m`: an eighth of a
/// usual field of view.
constexpr double kMinRotation_deg = 8.0;

bool has_frame(const Window& window, std::int64_t frame) {
  return std::ranges::any_of(window.frames, [&](const WindowFrame& in) { return in.id == frame; });
}

/// Copies the images of a frame, which share their pixels, and its static and dynamic features.
void fill(const TrackedFrame& frame, const DynamicReport& dynamic, DepartedKeyframe& keyframe) {
  keyframe.frame = frame.id;
  keyframe.t = frame.t;
  keyframe.gray = frame.gray;
  keyframe.depth = frame.depth;
  keyframe.depth_units_per_m = frame.depth_units_per_m;
  keyframe.features.clear();
  keyframe.dynamic_pixels.clear();
  keyframe.regions.clear();
  auto label = dynamic.labels.begin();
  for (const TrackedFeature& feature : frame.features) {
    while (label != dynamic.labels.end() && label->id < feature.id) ++label;
    const bool labeled = label != dynamic.labels.end() && label->id == feature.id;
    const Eigen::Vector2f pixel = feature.pixel.cast<float>();
    if (labeled && label->label != LabelClass::kStable) {
      keyframe.dynamic_pixels.push_back(pixel);
    } else {
      keyframe.features.push_back({feature.id, pixel, static_cast<float>(feature.depth)});
    }
  }
  for (const SemanticMask::MaskedBox& box : dynamic.mask.boxes())
    keyframe.regions.push_back({box.box, box.near_m, box.threshold_m});
}

void set_pose(const Pose& T_w_b, const Window& window, DepartedKeyframe& keyframe) {
  keyframe.T_w_b = T_w_b;
  keyframe.T_b_c = window.T_b_c;
  keyframe.gravity_b.reset();
  if (window.inertial) keyframe.gravity_b = (T_w_b.q.conjugate() * window.gravity_w).normalized();
}

}  // namespace

void KeyframeCollector::before_slide(const Window& window,
                                     const std::optional<UncertainPose>& oldest_motion) {
  oldest_.reset();
  next_.reset();
  oldest_motion_ = oldest_motion;
  if (window.frames.empty()) return;
  oldest_ = window.frames.front().id;
  oldest_T_w_b_ = window.frames.front().state.T_w_b;
  if (window.frames.size() > 1) next_ = window.frames[1].id;
}

void KeyframeCollector::after_slide(const Window& window, const TrackedFrame& frame,
                                    const DynamicReport& dynamic) {
  if (departed_) recycle(std::move(*std::exchange(departed_, std::nullopt)));
  if (oldest_ && !has_frame(window, *oldest_)) {
    depart(*oldest_, oldest_T_w_b_, window);
    add_motion(window);
  }
  discard_missing(window);
  if (!has_frame(window, frame.id)) return;
  DepartedKeyframe keyframe = unused();
  fill(frame, dynamic, keyframe);
  in_window_.push_back(std::move(keyframe));
}

DepartedKeyframe KeyframeCollector::unused() {
  if (unused_.empty()) return {};
  DepartedKeyframe keyframe = std::move(unused_.back());
  unused_.pop_back();
  return keyframe;
}

/// Continues `motion_` to the frame that is the oldest one now.
void KeyframeCollector::add_motion(const Window& window) {
  const bool known = motion_ && oldest_motion_ && !window.frames.empty() && window.frames.front().id == next_;
  motion_ = known ? std::optional(compose(*motion_, *oldest_motion_)) : std::nullopt;
}

void KeyframeCollector::depart(std::int64_t frame, const Pose& T_w_b, const Window& window) {
  const auto found = std::ranges::find(in_window_, frame, &DepartedKeyframe::frame);
  if (found == in_window_.end() || !located_ || !has_moved(T_w_b)) return;
  set_pose(T_w_b, window, *found);
  found->segment = segment_;
  found->motion_covariance.reset();
  if (motion_) found->motion_covariance = motion_->covariance;
  last_T_w_b_ = T_w_b;
  motion_ = UncertainPose{};
  departed_ = std::move(*found);
  in_window_.erase(found);
}

bool KeyframeCollector::has_moved(const Pose& T_w_b) const {
  if (!last_T_w_b_) return true;
  const double angle_deg = T_w_b.q.angularDistance(last_T_w_b_->q) * 180.0 / std::numbers::pi;
  return (T_w_b.p - last_T_w_b_->p).norm() >= config_.min_translation_m || angle_deg >= kMinRotation_deg;
}

void KeyframeCollector::discard_missing(const Window& window) {
  for (DepartedKeyframe& keyframe : in_window_) {
    if (!has_frame(window, keyframe.frame)) recycle(std::move(keyframe));
  }
  std::erase_if(in_window_,
                [&](const DepartedKeyframe& keyframe) { return !has_frame(window, keyframe.frame); });
}

void KeyframeCollector::set_located(bool located, int segment) {
  located_ = located;
  if (segment == segment_) return;
  segment_ = segment;
  last_T_w_b_.reset();
  motion_.reset();
}

std::optional<DepartedKeyframe> KeyframeCollector::take() { return std::exchange(departed_, std::nullopt); }

std::optional<DepartedKeyframe> KeyframeCollector::newest(const Window& window, std::int64_t frame) {
  if (!located_ || in_window_.empty() || in_window_.back().frame != frame) return std::nullopt;
  const auto state = std::ranges::find(window.frames, frame, &WindowFrame::id);
  if (state == window.frames.end()) return std::nullopt;
  DepartedKeyframe copy = unused();
  copy = in_window_.back();
  copy.segment = segment_;
  copy.motion_covariance.reset();
  set_pose(state->state.T_w_b, window, copy);
  return copy;
}

std::optional<DepartedKeyframe> KeyframeCollector::take_remaining(const Window& window) {
  while (!in_window_.empty() && !departed_) {
    const std::int64_t frame = in_window_.front().frame;
    const auto state = std::ranges::find(window.frames, frame, &WindowFrame::id);
    if (frame != window.frames.front().id) motion_.reset();
    if (state != window.frames.end()) depart(frame, state->state.T_w_b, window);
    if (!departed_) in_window_.erase(in_window_.begin());
  }
  return take();
}

}  // namespace stillpoint
