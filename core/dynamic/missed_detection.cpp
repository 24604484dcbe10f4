// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/missed_detection.h"

#include <algorithm>

namespace stillpoint {

const std::vector<TrackedBox>& MissedDetectionCompensation::update(const DetectionSet& set) {
  select_dynamic_classes(set);
  if (!config_.missed_detection) objects_.clear();
  count_frame(set.state == DetectionState::kPresent);
  boxes_.clear();
  assign_detections();
  remove_abandoned();
  for (const Object& object : objects_) {
    if (object.frames_since_detection() == 0) continue;
    boxes_.push_back({.id = object.id,
                      .class_name = object.class_name,
                      .box = predicted_and_grown(object),
                      .compensated = true});
  }
  return boxes_;
}

void MissedDetectionCompensation::select_dynamic_classes(const DetectionSet& set) {
  detections_.clear();
  if (set.state != DetectionState::kPresent) return;
  for (const Detection& detection : set.detections) {
    const bool dynamic = std::find(config_.classes.begin(), config_.classes.end(), detection.class_name) !=
                         config_.classes.end();
    if (dynamic && has_area(detection.box)) detections_.push_back(detection);
  }
}

/// Counts the new frame as missed or skipped for every object; `assign_detections` resets the counters.
void MissedDetectionCompensation::count_frame(bool has_detections) {
  for (Object& object : objects_) ++(has_detections ? object.missed : object.skipped);
}

Box MissedDetectionCompensation::predicted_and_grown(const Object& object) const {
  return expanded(object.predicted(), object.frames_since_detection() * config_.growth_px_per_miss);
}

/// Assigns each detection to a known or new object, and updates its box and velocity. Eqs. (3)-(4).
void MissedDetectionCompensation::assign_detections() {
  predictions_.clear();
  for (const Object& object : objects_) {
    predictions_.push_back({object.class_name, object.predicted(), predicted_and_grown(object)});
  }
  const std::vector<std::optional<std::size_t>>& object_of =
      association_.associate(predictions_, detections_, config_.min_iou);
  for (std::size_t i = 0; i < detections_.size(); ++i) {
    const Detection& detection = detections_[i];
    std::int64_t id = next_id_;
    if (object_of[i]) {
      Object& object = objects_[*object_of[i]];
      id = object.id;
      const Eigen::Vector2d velocity =
          (center_of(detection.box) - center_of(object.box)) / object.frames_since_detection();
      object.velocity = 0.5 * (velocity + object.velocity);
      object.box = detection.box;
      object.missed = 0;
      object.skipped = 0;
    } else {
      objects_.push_back({.id = next_id_++, .class_name = detection.class_name, .box = detection.box});
    }
    boxes_.push_back({.id = id, .class_name = detection.class_name, .box = detection.box});
  }
}

void MissedDetectionCompensation::remove_abandoned() {
  std::erase_if(objects_, [&](const Object& object) {
    return object.missed > config_.max_missed_frames || object.skipped > config_.max_skipped_frames;
  });
}

}  // namespace stillpoint
