// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/loop_run.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

Pose at_x(double x) { return {Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}}; }

/// Poses at 1 Hz, 1 m apart.
Trajectory straight(int count, double scale = 1.0) {
  Trajectory trajectory{.frame = "camera", .poses = {}};
  for (int k = 0; k < count; ++k) trajectory.poses.push_back({from_seconds(k), at_x(scale * k)});
  return trajectory;
}

/// A keyframe whose odometry drifted to `x_w`, and is corrected to `x_m`.
MapKeyframe keyframe(int k, double x_w, double x_m) {
  return {.frame = k, .t = from_seconds(k), .T_w_b = at_x(x_w), .T_m_b = at_x(x_m)};
}

TEST(LoopRun, CorrectionsAreInterpolatedBetweenKeyframes) {
  // Corrections: none at 1 s, -0.4 m at 3 s; constant outside.
  const LoopReport report{.loops = {}, .keyframes = {keyframe(1, 1.0, 1.0), keyframe(3, 3.0, 2.6)}};
  const Trajectory optimized = optimized_trajectory(straight(5), report);
  const std::vector<double> expected = {0.0, 1.0, 1.8, 2.6, 3.6};
  ASSERT_EQ(optimized.poses.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k)
    EXPECT_NEAR(optimized.poses[k].T_w_f.p.x(), expected[k], 1e-12);
}

TEST(LoopRun, TheOutputAtAKeyframeIsMovedToItsFinalPose) {
  // The output at 1 s was 1.0 m; the window refined it to 0.9 m, and the loops to 0.8 m. The camera is 0.1 m
  // before the body.
  LoopReport report{.loops = {}, .keyframes = {keyframe(0, -0.1, -0.1), keyframe(1, 0.8, 0.7)}};
  const Keyframe described{.T_b_c = at_x(0.1)};
  report.map = std::make_shared<KeyframeMap>(KeyframeMap{{described, described}});
  const Trajectory optimized = optimized_trajectory(straight(3), report);
  const std::vector<double> expected = {0.0, 0.8, 1.8};
  ASSERT_EQ(optimized.poses.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k)
    EXPECT_NEAR(optimized.poses[k].T_w_f.p.x(), expected[k], 1e-12);
}

TEST(LoopRun, WithoutKeyframesTheTrajectoryIsThatOfTheOdometry) {
  const Trajectory optimized = optimized_trajectory(straight(3), {});
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(optimized.poses[k].T_w_f.p, straight(3).poses[k].T_w_f.p);
}

}  // namespace
}  // namespace stillpoint::bench
