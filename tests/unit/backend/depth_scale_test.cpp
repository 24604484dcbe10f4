// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/depth_monitor.h"

#include <gtest/gtest.h>

#include "tests/support/simulated/simulated_window.h"

namespace stillpoint {
namespace {

Window window_with_depth_factor(double factor) {
  SimulatedWindowOptions options{.frames = 14, .points = 80};
  Window window = simulated_window(options);
  for (Landmark& landmark : window.landmarks) landmark.observations.back().depth *= factor;
  return window;
}

TEST(DepthScale, IsThatOfTheNewestFrame) {
  DepthScale scale;
  EXPECT_NEAR(scale.of_newest(window_with_depth_factor(1.0)).value(), 1.0, 0.01);
  EXPECT_NEAR(scale.of_newest(window_with_depth_factor(0.9)).value(), 0.9, 0.01);
}

/// The sensor is consistent with its estimated scale.
TEST(DepthScale, IsRelativeToTheEstimatedOne) {
  Window window = window_with_depth_factor(0.9);
  window.depth_scale = 0.9;
  EXPECT_NEAR(DepthScale().of_newest(window).value(), 1.0, 0.01);
}

}  // namespace
}  // namespace stillpoint
