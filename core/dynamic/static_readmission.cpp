// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/static_readmission.h"

#include <utility>

namespace stillpoint {

const std::vector<std::int64_t>& StaticReadmission::update(const ConsistencyView& view) {
  std::swap(previous_, anchors_);
  anchors_.clear();
  readmitted_.clear();
  const Pose& T_w_c = view.T_w_c.back();
  const Pose T_c_w = T_w_c.inverse();
  const auto is_static = [&](const Anchor& anchor, const Eigen::Vector2d& bearing) {
    const Eigen::Vector3d p_c = T_c_w * anchor.p_w;
    return p_c.z() > 0.0 && view.focal_px * (p_c.hnormalized() - bearing).norm() <= static_residual_px_;
  };
  auto known = previous_.begin();
  for (const ConsistencyFeature& feature : view.features) {
    const ConsistencyObservation& observation = view.observations_of(feature).back();
    while (known != previous_.end() && known->id < feature.id) ++known;
    const bool is_known = known != previous_.end() && known->id == feature.id;
    if (is_known && is_static(*known, observation.bearing)) {
      anchors_.push_back({.id = feature.id, .p_w = known->p_w, .static_frames = known->static_frames + 1});
      if (known->static_frames + 1 >= min_static_frames_) readmitted_.push_back(feature.id);
    } else if (observation.depth > 0.0) {
      const Eigen::Vector3d p_c = observation.depth * observation.bearing.homogeneous();
      anchors_.push_back({.id = feature.id, .p_w = T_w_c * p_c});
    }
  }
  return readmitted_;
}

}  // namespace stillpoint
