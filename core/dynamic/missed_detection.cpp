// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/missed_detection.h"

#include <algorithm>

namespace stillpoint {

const std::vector<TrackedBox>& MissedDetectionCompensation::update(const DetectionSet& set) {
  select_dynamic_classes(set);
  if (!config_.missed_detection) objects_.clear();
  advance(set.state == DetectionState::kPresent);
  boxes_.clear();
  take_up_detections();
  give_up_lost();
  for (const Object& object : objects_) {
    if (object.carried() == 0) continue;
    boxes_.push_back(
        {.id = object.id, .class_name = object.class_name, .box = carried_box(object), .compensated = true});
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

/// Counts the new picture against every object, until a detection is found for it.
void MissedDetectionCompensation::advance(bool watched) {
  for (Object& object : objects_) ++(watched ? object.missed : object.unwatched);
}

Box MissedDetectionCompensation::carried_box(const Object& object) const {
  return grown(object.predicted(), object.carried() * config_.growth_px_per_miss);
}

/// Gives each detection its object, an old one or a new one, and hands its box out. Eqs. (3)-(4).
void MissedDetectionCompensation::take_up_detections() {
  expected_.clear();
  for (const Object& object : objects_) {
    expected_.push_back({object.class_name, object.predicted(), carried_box(object)});
  }
  const std::vector<std::optional<std::size_t>>& object_of =
      association_.associate(expected_, detections_, config_.min_iou);
  for (std::size_t i = 0; i < detections_.size(); ++i) {
    const Detection& detection = detections_[i];
    std::int64_t id = next_id_;
    if (object_of[i]) {
      Object& object = objects_[*object_of[i]];
      id = object.id;
      const Eigen::Vector2d velocity = (center_of(detection.box) - center_of(object.box)) / object.carried();
      object.velocity = 0.5 * (velocity + object.velocity);
      object.box = detection.box;
      object.missed = 0;
      object.unwatched = 0;
    } else {
      objects_.push_back({.id = next_id_++, .class_name = detection.class_name, .box = detection.box});
    }
    boxes_.push_back({.id = id, .class_name = detection.class_name, .box = detection.box});
  }
}

void MissedDetectionCompensation::give_up_lost() {
  std::erase_if(objects_, [&](const Object& object) {
    return object.missed > config_.max_missed_frames || object.unwatched > config_.max_unwatched_frames;
  });
}

}  // namespace stillpoint
