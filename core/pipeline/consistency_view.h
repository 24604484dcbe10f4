// SPDX-License-Identifier: BSD-3-Clause
/// The window as the moving consistency check sees it. Paper Sec. III-E.
#pragma once

#include "core/backend/window.h"
#include "core/dynamic/moving_consistency.h"

namespace stillpoint {

/// Every feature that the newest picture sees, whatever its verdict; poses as they are in the window now.
[[nodiscard]] inline ConsistencyView consistency_view(const Window& window, double focal_px) {
  ConsistencyView view{.focal_px = focal_px};
  for (int frame = 0; frame <= window.newest(); ++frame) view.T_w_c.push_back(window.T_w_c(frame));
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.last() != window.newest()) continue;
    ConsistencyFeature feature{.id = landmark.id, .inverse_depth = landmark.inverse_depth};
    for (int frame = landmark.host; frame <= landmark.last(); ++frame) {
      const Observation& seen = landmark.in(frame);
      feature.observations.push_back({.frame = frame, .bearing = seen.bearing, .depth = seen.depth});
    }
    view.features.push_back(std::move(feature));
  }
  return view;
}

}  // namespace stillpoint
