// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/box_association.h"

#include <algorithm>
#include <tuple>

#include "core/types/box_geometry.h"

namespace stillpoint {
namespace {

struct Pair {
  double cost = 0.0;
  std::size_t object = 0;
  std::size_t detection = 0;
};

/// What may be joined, cheapest first. `cost` says nothing where a pair may not be joined.
template <class Cost>
std::vector<Pair> sorted_pairs(std::span<const ExpectedBox> objects, std::span<const Detection> detections,
                               const Cost& cost) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t j = 0; j < detections.size(); ++j) {
      if (objects[i].class_name != detections[j].class_name) continue;
      const std::optional<double> value = cost(objects[i], detections[j].box);
      if (value) pairs.push_back({*value, i, j});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.cost, a.object, a.detection) < std::tie(b.cost, b.object, b.detection);
  });
  return pairs;
}

}  // namespace

std::vector<std::optional<std::size_t>> associate(std::span<const ExpectedBox> objects,
                                                  std::span<const Detection> detections, double min_iou) {
  std::vector<std::optional<std::size_t>> object_of(detections.size());
  std::vector<bool> taken(objects.size(), false);
  const auto join = [&](const std::vector<Pair>& pairs) {
    for (const Pair& pair : pairs) {
      if (taken[pair.object] || object_of[pair.detection]) continue;
      taken[pair.object] = true;
      object_of[pair.detection] = pair.object;
    }
  };
  join(sorted_pairs(objects, detections, [&](const ExpectedBox& object, const Box& box) {
    const double shared = overlap(object.predicted, box);
    return shared >= min_iou ? std::optional(-shared) : std::nullopt;
  }));
  join(sorted_pairs(objects, detections, [](const ExpectedBox& object, const Box& box) {
    const Eigen::Vector2d center = center_of(box);
    return contains(object.reach, center) ? std::optional((center - center_of(object.predicted)).norm())
                                          : std::nullopt;
  }));
  return object_of;
}

}  // namespace stillpoint
