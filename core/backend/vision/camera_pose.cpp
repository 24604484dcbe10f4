// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/vision/camera_pose.h"

#include <utility>

namespace stillpoint {

Pose product(const Pose& T_a_b, const Pose& T_b_c) {
  Pose (*volatile const product_of_poses)(const Pose&, const Pose&) = &operator*;
  return product_of_poses(T_a_b, T_b_c);
}

std::vector<PointObservation> known_points(const Window& window, const DepthConfig& depth,
                                           std::vector<PointObservation> recycled) {
  std::vector<PointObservation> observations = std::move(recycled);
  observations.clear();
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.dynamic || landmark.last() != window.newest() || landmark.host == window.newest()) continue;
    const Observation& host = landmark.observations.front();
    const double measured_m = host.depth / window.depth_scale;
    const bool measured = measured_m > 0.0 && measured_m <= depth.max_m;
    double inverse_depth = landmark.inverse_depth;
    if (inverse_depth <= 0.0 && measured) inverse_depth = 1.0 / measured_m;
    if (inverse_depth <= 0.0) continue;
    observations.push_back({window.position(landmark, inverse_depth), landmark.observations.back().bearing});
  }
  return observations;
}

}  // namespace stillpoint
