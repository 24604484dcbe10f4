// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/initial_prior.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

/// Two frames 1 m apart along x.
Window two_frames() {
  Window window;
  window.frames.resize(2);
  window.frames[1].state.T_w_b.p.x() = 1.0;
  return window;
}

TEST(RestoreGauge, MovesTheWholeWindowBackAfterAJump) {
  Window window = two_frames();
  const Pose oldest = window.frames.front().state.T_w_b;
  const Pose jump{Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY())), {0.0, 0.6, 0.2}};
  for (WindowFrame& frame : window.frames) frame.state.T_w_b = jump * frame.state.T_w_b;
  EXPECT_TRUE(restore_gauge(oldest, {}, window));
  EXPECT_LT(window.frames[0].state.T_w_b.p.norm(), 1e-12);
  EXPECT_LT((window.frames[1].state.T_w_b.p - Eigen::Vector3d::UnitX()).norm(), 1e-12);
}

TEST(RestoreGauge, IgnoresAShiftOfCentimeters) {
  Window window = two_frames();
  const Pose oldest = window.frames.front().state.T_w_b;
  for (WindowFrame& frame : window.frames) frame.state.T_w_b.p.y() += 0.05;
  EXPECT_FALSE(restore_gauge(oldest, {}, window));
  EXPECT_EQ(window.frames[0].state.T_w_b.p.y(), 0.05);
}

}  // namespace
}  // namespace stillpoint
