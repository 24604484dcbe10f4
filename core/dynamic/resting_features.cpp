// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/resting_features.h"

#include <utility>

namespace stillpoint {

const std::vector<std::int64_t>& RestingFeatures::update(const ConsistencyView& view) {
  std::swap(before_, places_);
  places_.clear();
  resting_.clear();
  const Pose& T_w_c = view.T_w_c.back();
  const Pose T_c_w = T_w_c.inverse();
  const auto stays = [&](const Place& place, const Eigen::Vector2d& bearing) {
    const Eigen::Vector3d p_c = T_c_w * place.p_w;
    return p_c.z() > 0.0 && view.focal_px * (p_c.hnormalized() - bearing).norm() <= stray_px_;
  };
  auto known = before_.begin();
  for (const ConsistencyFeature& feature : view.features) {
    const ConsistencyObservation& seen = view.seen_of(feature).back();
    while (known != before_.end() && known->id < feature.id) ++known;
    const bool is_known = known != before_.end() && known->id == feature.id;
    if (is_known && stays(*known, seen.bearing)) {
      places_.push_back({.id = feature.id, .p_w = known->p_w, .stayed = known->stayed + 1});
      if (known->stayed + 1 >= pictures_) resting_.push_back(feature.id);
    } else if (seen.depth > 0.0) {
      const Eigen::Vector3d p_c = seen.depth * seen.bearing.homogeneous();
      places_.push_back({.id = feature.id, .p_w = T_w_c * p_c});
    }
  }
  return resting_;
}

}  // namespace stillpoint
