// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/depth_initialization.h"

#include <gtest/gtest.h>

#include "tests/support/simulated/window_world.h"

namespace stillpoint {
namespace {

constexpr double kFocal_px = 500.0;

TEST(DepthInitialization, TriangulatesExactTracks) {
  const Window window = visual_window(6, 20);
  for (const Landmark& landmark : window.landmarks) {
    EXPECT_NEAR(triangulate_depth(window, landmark, 1e-4), 1.0 / landmark.inverse_depth, 1e-9);
  }
}

TEST(DepthInitialization, ReturnsZeroWithoutParallax) {
  Window window = visual_window(6, 1);
  for (WindowFrame& frame : window.frames) frame.state.T_w_b.p.setZero();
  EXPECT_EQ(triangulate_depth(window, window.landmarks[0], 1.5 / kFocal_px), 0.0);
}

TEST(DepthInitialization, IgnoresADepthThatNoOtherViewConfirms) {
  Window window = visual_window(6, 1);
  Landmark& landmark = window.landmarks[0];
  const double truth = 1.0 / landmark.inverse_depth;
  landmark.inverse_depth = 0.0;
  landmark.observations[0].depth = 0.5;  // at a depth edge: reprojection errors far above 10 px
  for (std::size_t i = 2; i < landmark.observations.size(); ++i) landmark.observations[i].depth = 0.0;
  initialize_depths({}, kFocal_px, window);
  EXPECT_NEAR(1.0 / landmark.inverse_depth, truth, 1e-9);  // from the only correct depth, in frame 1
  EXPECT_EQ(landmark.source, DepthSource::kMeasured);
}

/// An error of the depth by k standard deviations in a window whose cameras are close together: its
/// reprojection error is far below 10 px.
double initialized_depth(double sigmas) {
  Window window = visual_window(6, 1);
  for (WindowFrame& frame : window.frames) frame.state.T_w_b.p *= 3.0;
  Landmark& landmark = window.landmarks[0];
  const double depth = 1.0 / landmark.inverse_depth;
  const Eigen::Vector3d p_w = window.position(landmark);
  for (int frame = 0; frame <= landmark.last(); ++frame) {
    Observation& observation = landmark.observations[static_cast<std::size_t>(frame)];
    observation.bearing = (window.T_w_c(frame).inverse() * p_w).hnormalized();
    observation.depth = 0.0;
  }
  landmark.inverse_depth = 0.0;
  BackendConfig config;
  config.feature_sigma_px = 0.1;
  config.depth.agreement_probability = 0.99;
  landmark.observations[0].depth = depth + sigmas * config.depth.inverse_sigma * depth * depth;
  initialize_depths(config, kFocal_px, window);
  return landmark.source == DepthSource::kMeasured ? 1.0 / landmark.inverse_depth / depth : 0.0;
}

TEST(DepthInitialization, AcceptsADepthWithinItsCovariance) {
  EXPECT_NEAR(initialized_depth(2.0), 1.0, 0.05);
  EXPECT_EQ(initialized_depth(30.0), 0.0);
}

TEST(DepthInitialization, IgnoresDepthsBeyondTheLimit) {
  Window window = visual_window(6, 1);
  Landmark& landmark = window.landmarks[0];
  landmark.inverse_depth = 0.0;
  BackendConfig config;
  config.depth.max_m = 1.0;
  initialize_depths(config, kFocal_px, window);
  EXPECT_EQ(landmark.source, DepthSource::kTriangulated);
}

}  // namespace
}  // namespace stillpoint
