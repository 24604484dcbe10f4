// SPDX-License-Identifier: BSD-3-Clause
/// The window as the moving consistency check sees it. Paper Sec. III-E.
#pragma once

#include <utility>

#include "core/backend/depth_initialization.h"
#include "core/backend/window.h"
#include "core/dynamic/moving_consistency.h"

namespace stillpoint {

/// Inverse depth in the host [1/m]; 0 = unknown. The solver knows nothing of features that are kept out of
/// it: theirs is the depth at which they would stand still, if there is parallax enough to tell.
[[nodiscard]] inline double inverse_depth_of(const Window& window, const Landmark& landmark,
                                             double bearing_sigma) {
  if (!landmark.dynamic) return landmark.inverse_depth;
  const double depth = triangulate_depth(window, landmark, bearing_sigma);
  return depth > 0.0 ? 1.0 / depth : 0.0;
}

/// Every feature that the newest picture sees, whatever its verdict; poses as they are in the window now.
/// @param pixel_sigma_px of a feature's position
/// @param memory for the result: a view that nobody needs any more
[[nodiscard]] inline ConsistencyView consistency_view(const Window& window, double focal_px,
                                                      double pixel_sigma_px, ConsistencyView memory) {
  ConsistencyView view = std::move(memory);
  view.focal_px = focal_px;
  view.T_w_c.clear();
  view.features.clear();
  view.observations.clear();
  for (int frame = 0; frame <= window.newest(); ++frame) view.T_w_c.push_back(window.T_w_c(frame));
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.last() != window.newest()) continue;
    view.features.push_back({.id = landmark.id,
                             .inverse_depth = inverse_depth_of(window, landmark, pixel_sigma_px / focal_px),
                             .first = view.observations.size(),
                             .count = landmark.observations.size()});
    for (int frame = landmark.host; frame <= landmark.last(); ++frame) {
      const Observation& seen = landmark.in(frame);
      view.observations.push_back({.frame = frame, .bearing = seen.bearing, .depth = seen.depth});
    }
  }
  return view;
}

}  // namespace stillpoint
