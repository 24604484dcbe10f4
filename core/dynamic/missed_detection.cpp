// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/missed_detection.h"

#include <algorithm>
#include <tuple>

#include "core/types/detection.h"

namespace stillpoint {
namespace {

/// Smallest overlap that associates a detection with a predicted box; not in the paper. At 0.3 a box of a
/// person may have moved by half of its width.
constexpr double kMinIou = 0.3;

}  // namespace

/// Assigns admissible pairs in order of increasing cost. `cost` returns nullopt for an inadmissible pair.
template <class Cost>
void BoxAssociation::assign_greedily(std::span<const PredictedBox> objects,
                                     std::span<const Detection> detections, const Cost& cost) {
  candidates_.clear();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t j = 0; j < detections.size(); ++j) {
      if (objects[i].class_name != detections[j].class_name) continue;
      const std::optional<double> value = cost(objects[i], detections[j].box);
      if (value) candidates_.push_back({*value, i, j});
    }
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.cost, a.object, a.detection) < std::tie(b.cost, b.object, b.detection);
  });
  for (const Candidate& candidate : candidates_) {
    if (object_assigned_[candidate.object] || object_of_[candidate.detection]) continue;
    object_assigned_[candidate.object] = true;
    object_of_[candidate.detection] = candidate.object;
  }
}

const std::vector<std::optional<std::size_t>>& BoxAssociation::associate(
    std::span<const PredictedBox> objects, std::span<const Detection> detections, double min_iou) {
  object_of_.assign(detections.size(), std::nullopt);
  object_assigned_.assign(objects.size(), false);
  assign_greedily(objects, detections, [&](const PredictedBox& object, const Box& box) {
    const double iou = intersection_over_union(object.box, box);
    return iou >= min_iou ? std::optional(-iou) : std::nullopt;
  });
  assign_greedily(objects, detections, [](const PredictedBox& object, const Box& box) {
    const Eigen::Vector2d center = center_of(box);
    return contains(object.gate, center) ? std::optional((center - center_of(object.box)).norm())
                                         : std::nullopt;
  });
  return object_of_;
}

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
      association_.associate(predictions_, detections_, kMinIou);
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
