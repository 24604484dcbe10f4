// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/box_association.h"

#include <algorithm>
#include <tuple>

#include "core/types/box_geometry.h"

namespace stillpoint {

/// Joins what may be joined, cheapest first. `cost` says nothing where a pair may not be joined.
template <class Cost>
void BoxAssociation::join(std::span<const ExpectedBox> objects, std::span<const Detection> detections,
                          const Cost& cost) {
  pairs_.clear();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t j = 0; j < detections.size(); ++j) {
      if (objects[i].class_name != detections[j].class_name) continue;
      const std::optional<double> value = cost(objects[i], detections[j].box);
      if (value) pairs_.push_back({*value, i, j});
    }
  }
  std::sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.cost, a.object, a.detection) < std::tie(b.cost, b.object, b.detection);
  });
  for (const Pair& pair : pairs_) {
    if (taken_[pair.object] || object_of_[pair.detection]) continue;
    taken_[pair.object] = true;
    object_of_[pair.detection] = pair.object;
  }
}

const std::vector<std::optional<std::size_t>>& BoxAssociation::associate(
    std::span<const ExpectedBox> objects, std::span<const Detection> detections, double min_iou) {
  object_of_.assign(detections.size(), std::nullopt);
  taken_.assign(objects.size(), false);
  join(objects, detections, [&](const ExpectedBox& object, const Box& box) {
    const double shared = overlap(object.predicted, box);
    return shared >= min_iou ? std::optional(-shared) : std::nullopt;
  });
  join(objects, detections, [](const ExpectedBox& object, const Box& box) {
    const Eigen::Vector2d center = center_of(box);
    return contains(object.reach, center) ? std::optional((center - center_of(object.predicted)).norm())
                                          : std::nullopt;
  });
  return object_of_;
}

}  // namespace stillpoint
