// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/box_association.h"

#include <algorithm>
#include <tuple>

#include "core/types/box_geometry.h"

namespace stillpoint {

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

}  // namespace stillpoint
