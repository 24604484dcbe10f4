// SPDX-License-Identifier: BSD-3-Clause
/// A noise-free window of a few poses and points, for tests of the backend.
#pragma once

#include "core/backend/window/window.h"
#include "core/geometry/so3.h"
#include "tests/support/random.h"

namespace stillpoint {

/// `frames` cameras on a curve and `points` points 2-4 m away; every camera observes every point with depth.
inline Window visual_window(int frames, int points) {
  Random random(3);
  Window window;
  for (int i = 0; i < frames; ++i) {
    WindowFrame frame;
    frame.id = i;
    frame.state.t = from_seconds(0.1 * i);
    frame.state.T_w_b = Pose{exp_so3({0.0, 0.02 * i, 0.01 * i}), {0.05 * i, 0.01 * i * i, 0.02 * i}};
    window.frames.push_back(frame);
  }
  for (int k = 0; k < points; ++k) {
    const Eigen::Vector3d p_w = random.uniform3({-1.0, -0.8, 2.0}, {1.0, 0.8, 4.0});
    Landmark landmark{.id = k};
    for (int i = 0; i < frames; ++i) {
      const Eigen::Vector3d p_c = window.T_w_c(i).inverse() * p_w;
      landmark.observations.push_back({.bearing = p_c.hnormalized(), .depth = p_c.z()});
      if (i == 0) landmark.inverse_depth = 1.0 / p_c.z();
    }
    landmark.source = DepthSource::kMeasured;
    window.landmarks.push_back(landmark);
  }
  return window;
}

}  // namespace stillpoint
