// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/loop_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/so3.h"

namespace stillpoint::eval {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Two laps of 40 s around a circle of 3 m, looking ahead, at 10 Hz.
Pose pose_on_lap(double t_s) {
  const double angle = 2.0 * std::numbers::pi * t_s / 40.0;
  return {exp_so3(Eigen::Vector3d(0.0, 0.0, angle)),
          3.0 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0)};
}

Trajectory two_laps() {
  Trajectory gt{"camera", {}};
  for (int i = 0; i <= 800; ++i) gt.poses.push_back({from_seconds(0.1 * i), pose_on_lap(0.1 * i)});
  return gt;
}

std::vector<Timestamp> keyframes_at(double interval_s) {
  std::vector<Timestamp> times;
  for (double t_s = 0.0; t_s < 79.99; t_s += interval_s) times.push_back(from_seconds(t_s));
  return times;
}

/// A loop whose translation is off by `error_m` and whose rotation is off by `error_deg`.
ReportedLoop loop_between(double query_s, double match_s, double error_m, double error_deg) {
  Pose T = pose_on_lap(match_s).inverse() * pose_on_lap(query_s);
  T.p.x() += error_m;
  T.q = T.q * exp_so3(Eigen::Vector3d(0.0, error_deg * kDegree, 0.0));
  return {from_seconds(query_s), from_seconds(match_s), T, true};
}

TEST(Revisits, CountsTrueAndFalseLoops) {
  std::vector<ReportedLoop> loops{loop_between(50.0, 10.0, 0.19, 0.0), loop_between(51.0, 11.0, 0.21, 0.0),
                                  loop_between(52.0, 12.0, 0.0, 4.9), loop_between(53.0, 13.0, 0.0, 5.1),
                                  loop_between(54.0, 14.0, 0.0, 0.0)};
  loops.back().accepted = false;
  const RevisitScore score = score_revisits(two_laps(), keyframes_at(1.0), loops);
  EXPECT_EQ(score.true_loops, 2U);
  EXPECT_EQ(score.false_loops, 2U);
  EXPECT_EQ(score.missed_loops, 1U);
}

TEST(Revisits, TheSecondLapIsRevisitedAndTheFirstIsNot) {
  // Keyframes each second are 3 * 2 pi / 40 = 0.47 m and 9 degrees apart: those from 38 s on are within two
  // keyframes (0.94 m, 18 degrees) of the first one. 38 .. 79 are 42 keyframes.
  const RevisitScore score =
      score_revisits(two_laps(), keyframes_at(1.0), std::vector{loop_between(50.0, 10.0, 0.0, 0.0)});
  EXPECT_EQ(score.revisits, 42U);
  EXPECT_EQ(score.recognized, 1U);
  EXPECT_NEAR(score.recall.value(), 1.0 / 42.0, 1e-12);
}

TEST(Revisits, ACameraThatStaysIsNotARevisit) {
  Trajectory gt{"camera", {}};
  for (int i = 0; i <= 800; ++i) gt.poses.push_back({from_seconds(0.1 * i), Pose{}});
  const RevisitScore score = score_revisits(gt, keyframes_at(1.0), {});
  EXPECT_EQ(score.revisits, 0U);
  EXPECT_FALSE(score.recall.has_value());
}

TEST(Revisits, LoopsWithoutATruePoseAreLeftOut) {
  Trajectory gt = two_laps();
  std::erase_if(gt.poses, [](const StampedPose& pose) { return pose.t > from_seconds(45.0); });
  const RevisitScore score =
      score_revisits(gt, keyframes_at(1.0), std::vector{loop_between(50.0, 10.0, 9.0, 0.0)});
  EXPECT_EQ(score.false_loops, 0U);
  EXPECT_EQ(score.revisits, 8U);  // 38 .. 45 s
}

}  // namespace
}  // namespace stillpoint::eval
