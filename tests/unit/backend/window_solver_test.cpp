// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/sliding_window.h"

#include <gtest/gtest.h>

#include "core/backend/start/initial_prior.h"
#include "tests/support/published_config.h"
#include "tests/support/simulated/window_world.h"

namespace stillpoint {
namespace {

constexpr double kFocal_px = 500.0;

/// A landmark without depth whose parallax has the wrong sign: the best inverse depth is negative.
Landmark landmark_beyond_infinity(const Window& window) {
  constexpr double kInverseDepth = -1.0;
  const Eigen::Vector3d ray(0.1, 0.2, 1.0);
  Landmark landmark{.id = 1000, .inverse_depth = 0.3, .source = DepthSource::kTriangulated};
  for (int i = 0; i <= window.newest(); ++i) {
    const Pose T_ci_c0 = window.T_w_c(i).inverse() * window.T_w_c(0);
    const Eigen::Vector3d point = T_ci_c0.q * ray + kInverseDepth * T_ci_c0.p;
    landmark.observations.push_back({.bearing = point.hnormalized()});
  }
  return landmark;
}

TEST(WindowSolver, ALandmarkBeyondInfinityDoesNotAffectTheOthers) {
  const Window truth = visual_window(5, 30);
  Window window = truth;
  BackendConfig config = published_config().backend;
  config.depth.usage = DepthUsage::kWeighted;
  window.prior = initial_prior(window, config);
  window.landmarks.push_back(landmark_beyond_infinity(truth));
  for (int i = 1; i <= window.newest(); ++i) {
    window.frames[static_cast<std::size_t>(i)].state.T_w_b.p += Eigen::Vector3d(0.01, -0.02, 0.015);
  }
  ASSERT_TRUE(make_window_solver(config.solver)->solve(window, config, kFocal_px).usable);
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    EXPECT_LT((window.frames[i].state.T_w_b.p - truth.frames[i].state.T_w_b.p).norm(), 1e-4);
  }
  EXPECT_EQ(window.landmarks.back().inverse_depth, 0.0);  // reset, to be initialized again
}

}  // namespace
}  // namespace stillpoint
