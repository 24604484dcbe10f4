// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/missed_detection.h"

#include <algorithm>

#include "core/dynamic/box_association.h"

namespace stillpoint {

std::vector<TrackedBox> MissedDetectionCompensation::update(const DetectionSet& set) {
  const std::vector<Detection> detections = of_dynamic_classes(set);
  if (!config_.missed_detection) objects_.clear();
  advance(set.state == DetectionState::kPresent);
  const std::vector<std::int64_t> ids = take_up(detections);
  give_up_lost();

  std::vector<TrackedBox> boxes;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    boxes.push_back({.id = ids[i], .class_name = detections[i].class_name, .box = detections[i].box});
  }
  for (const Object& object : objects_) {
    if (object.carried() == 0) continue;
    boxes.push_back(
        {.id = object.id, .class_name = object.class_name, .box = carried_box(object), .compensated = true});
  }
  return boxes;
}

std::vector<Detection> MissedDetectionCompensation::of_dynamic_classes(const DetectionSet& set) const {
  std::vector<Detection> kept;
  if (set.state != DetectionState::kPresent) return kept;
  for (const Detection& detection : set.detections) {
    const bool dynamic = std::find(config_.classes.begin(), config_.classes.end(), detection.class_name) !=
                         config_.classes.end();
    if (dynamic && has_area(detection.box)) kept.push_back(detection);
  }
  return kept;
}

/// Counts the new picture against every object, until a detection is found for it.
void MissedDetectionCompensation::advance(bool watched) {
  for (Object& object : objects_) ++(watched ? object.missed : object.unwatched);
}

Box MissedDetectionCompensation::carried_box(const Object& object) const {
  return grown(object.predicted(), object.carried() * config_.growth_px_per_miss);
}

/// Gives each detection its object, an old one or a new one, and updates it. Eqs. (3)-(4).
std::vector<std::int64_t> MissedDetectionCompensation::take_up(const std::vector<Detection>& detections) {
  std::vector<ExpectedBox> expected;
  for (const Object& object : objects_) {
    expected.push_back({object.class_name, object.predicted(), carried_box(object)});
  }
  const std::vector<std::optional<std::size_t>> object_of = associate(expected, detections, config_.min_iou);
  std::vector<std::int64_t> ids;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    const Box& box = detections[i].box;
    if (!object_of[i]) {
      objects_.push_back({.id = next_id_++, .class_name = detections[i].class_name, .box = box});
      ids.push_back(objects_.back().id);
      continue;
    }
    Object& object = objects_[*object_of[i]];
    const Eigen::Vector2d velocity = (center_of(box) - center_of(object.box)) / object.carried();
    object.velocity = 0.5 * (velocity + object.velocity);
    object.box = box;
    object.missed = 0;
    object.unwatched = 0;
    ids.push_back(object.id);
  }
  return ids;
}

void MissedDetectionCompensation::give_up_lost() {
  std::erase_if(objects_, [&](const Object& object) {
    return object.missed > config_.max_missed_frames || object.unwatched > config_.max_unwatched_frames;
  });
}

}  // namespace stillpoint
