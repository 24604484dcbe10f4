// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/run_scores.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

Pose at_x(double x) { return {Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}}; }

/// Poses at 1 Hz, 1 m apart, in one segment.
std::vector<Trajectory> straight(int count, int begin = 0) {
  Trajectory trajectory{.frame = "camera", .poses = {}};
  for (int k = 0; k < count; ++k) trajectory.poses.push_back({from_seconds(begin + k), at_x(k)});
  return {trajectory};
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
  for (MapKeyframe& keyframe : report.keyframes) keyframe.T_b_c = at_x(0.1);
  const Trajectory optimized = optimized_trajectory(straight(3), report);
  const std::vector<double> expected = {0.0, 0.8, 1.8};
  ASSERT_EQ(optimized.poses.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k)
    EXPECT_NEAR(optimized.poses[k].T_w_f.p.x(), expected[k], 1e-12);
}

TEST(LoopRun, WithoutKeyframesTheTrajectoryIsThatOfTheOdometry) {
  const Trajectory optimized = optimized_trajectory(straight(3), {});
  ASSERT_EQ(optimized.poses.size(), 3u);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(optimized.poses[static_cast<std::size_t>(k)].T_w_f.p, at_x(k).p);
}

TEST(LoopRun, LaterSegmentsAreMovedIntoTheMapIfTheyAreLocatedInIt) {
  // The second segment begins at 3 s and 10 m, the third one is not located.
  std::vector<Trajectory> segments = straight(2);
  segments.push_back(straight(2, 3).front());
  segments.push_back(straight(2, 6).front());
  LoopReport report{.loops = {}, .keyframes = {keyframe(1, 1.0, 0.9), keyframe(3, 0.0, 10.0)}};
  report.keyframes.back().segment = 1;
  report.keyframes.push_back(keyframe(6, 0.0, 0.0));
  report.keyframes.back().segment = 2;
  report.keyframes.back().is_located = false;
  const Trajectory optimized = optimized_trajectory(segments, report);
  const std::vector<std::pair<double, double>> expected = {{0.0, -0.1}, {1.0, 0.9}, {3.0, 10.0}, {4.0, 11.0}};
  ASSERT_EQ(optimized.poses.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(optimized.poses[k].t, from_seconds(expected[k].first));
    EXPECT_NEAR(optimized.poses[k].T_w_f.p.x(), expected[k].second, 1e-12);
  }
}

/// Poses at 1 Hz on a parabola, off in z from 20 s on.
Trajectory drifting(double error_m) {
  Trajectory trajectory{.frame = "camera", .poses = {}};
  for (int k = 0; k < 30; ++k) {
    const double t = k;
    trajectory.poses.push_back(
        {from_seconds(t), {Eigen::Quaterniond::Identity(), {t, 0.1 * t * t, k < 20 ? 0.0 : error_m}}});
  }
  return trajectory;
}

TEST(LoopRun, TheErrorAfterTheFirstLoopIsThatAfterTheFirstAcceptedOne) {
  LoopRun run{.causal = drifting(0.1), .optimized = drifting(0.0), .report = {}};
  run.report.loops = {{.query_t = from_seconds(12), .outcome = LoopOutcome::kFewInliers},
                      {.query_t = from_seconds(19), .outcome = LoopOutcome::kAccepted}};
  // From 20 s on: 0.1 m and 0.3 m. From 13 s on, after the refused one, it would be less.
  const LoopScore score = score_loops(drifting(0.0), drifting(0.3), run);
  ASSERT_TRUE(score.after_first.has_value());
  EXPECT_NEAR(score.after_first->odometry_m, 0.3, 1e-9);
  EXPECT_NEAR(score.after_first->causal_m, 0.1, 1e-9);
}

TEST(LoopRun, WithoutAcceptedLoopsOrWithALoadedMapThereIsNoErrorAfterALoop) {
  LoopRun run{.causal = drifting(0.1), .optimized = drifting(0.0), .report = {}};
  EXPECT_FALSE(score_loops(drifting(0.0), drifting(0.3), run).after_first);
  run.report.loops = {{.query_t = from_seconds(19), .outcome = LoopOutcome::kAccepted}};
  run.has_map = true;
  EXPECT_FALSE(score_loops(drifting(0.0), drifting(0.3), run).after_first);
}

}  // namespace
}  // namespace stillpoint::bench
