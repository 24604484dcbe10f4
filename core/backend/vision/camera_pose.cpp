// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/vision/camera_pose.h"

#include <optional>
#include <utility>

#include "core/config/monitor_config.h"

namespace stillpoint {

Pose product(const Pose& T_a_b, const Pose& T_b_c) {
  Pose (*volatile const product_of_poses)(const Pose&, const Pose&) = &operator*;
  return product_of_poses(T_a_b, T_b_c);
}

namespace {

/// Observed in the newest frame, at the position known from earlier ones.
std::optional<PointObservation> known_point(const Window& window, const Landmark& landmark,
                                            const DepthConfig& depth) {
  if (landmark.last() != window.newest() || landmark.host == window.newest()) return std::nullopt;
  const double measured_m = landmark.observations.front().depth / window.depth_scale;
  const bool measured = measured_m > 0.0 && measured_m <= depth.max_m;
  double inverse_depth = landmark.inverse_depth;
  if (inverse_depth <= 0.0 && measured) inverse_depth = 1.0 / measured_m;
  if (inverse_depth <= 0.0) return std::nullopt;
  return PointObservation{window.position(landmark, inverse_depth), landmark.observations.back().bearing};
}

}  // namespace

std::vector<PointObservation> known_points(const Window& window, const DepthConfig& depth,
                                           std::vector<PointObservation> recycled) {
  std::vector<PointObservation> observations = std::move(recycled);
  observations.clear();
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.dynamic) continue;
    if (const auto point = known_point(window, landmark, depth)) observations.push_back(*point);
  }
  return observations;
}

std::vector<PointObservation> old_points(const Window& window, const DepthConfig& depth,
                                         std::vector<PointObservation> recycled) {
  std::vector<PointObservation> observations = std::move(recycled);
  observations.clear();
  const Timestamp newest = window.frames.back().state.t;
  for (const Landmark& landmark : window.landmarks) {
    const Timestamp begin = window.frames[static_cast<std::size_t>(landmark.host)].state.t;
    if (seconds_between(begin, newest) < kMonitor.vision.min_witness_age_s) continue;
    if (const auto point = known_point(window, landmark, depth)) observations.push_back(*point);
  }
  return observations;
}

}  // namespace stillpoint
