// SPDX-License-Identifier: BSD-3-Clause
/// Converts the sliding window to the input of the moving consistency check. Paper Sec. III-E.
#pragma once

#include <utility>

#include "core/backend/start/depth_initialization.h"
#include "core/backend/window/window.h"
#include "core/dynamic/moving_consistency.h"

namespace stillpoint {

/// Inverse depth in the host frame [1/m]; 0 = unknown. Dynamic landmarks are not optimized: their depth is
/// triangulated under the assumption that they are static, and unknown if the parallax is too small.
[[nodiscard]] inline double inverse_depth_of(const Window& window, const Landmark& landmark,
                                             double bearing_sigma) {
  if (!landmark.dynamic) return landmark.inverse_depth;
  const double depth = triangulate_depth(window, landmark, bearing_sigma);
  return depth > 0.0 ? 1.0 / depth : 0.0;
}

/// All features observed in the newest frame, of any label, with the current poses of the window.
/// @param feature_sigma_px standard deviation of a feature position [px]
/// @param recycled a result that is no longer needed; its memory is reused
[[nodiscard]] inline ConsistencyView consistency_view(const Window& window, double focal_px,
                                                      double feature_sigma_px, ConsistencyView recycled) {
  ConsistencyView view = std::move(recycled);
  view.focal_px = focal_px;
  view.T_w_c.clear();
  view.features.clear();
  view.observations.clear();
  for (int frame = 0; frame <= window.newest(); ++frame) view.T_w_c.push_back(window.T_w_c(frame));
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.last() != window.newest()) continue;
    view.features.push_back({.id = landmark.id,
                             .inverse_depth = inverse_depth_of(window, landmark, feature_sigma_px / focal_px),
                             .first = view.observations.size(),
                             .count = landmark.observations.size()});
    for (int frame = landmark.host; frame <= landmark.last(); ++frame) {
      const Observation& observation = landmark.observation_in(frame);
      view.observations.push_back(
          {.frame = frame, .bearing = observation.bearing, .depth = observation.depth / window.depth_scale});
    }
  }
  return view;
}

}  // namespace stillpoint
