// SPDX-License-Identifier: BSD-3-Clause
/// Three ways in which a bad run looks good: what the public tools print, and what strict recipes print.
#include <gtest/gtest.h>

#include <cmath>

#include "eval/recipes/recipe.h"

namespace stillpoint {
namespace {

constexpr double kPi = 3.14159265358979323846;

Pose on_circle(double t) {
  // 0.5 m/s on a circle of 2 m radius, looking ahead.
  const double angle = 0.25 * t;
  const Eigen::Quaterniond q(Eigen::AngleAxisd(angle + kPi / 2, Eigen::Vector3d::UnitZ()));
  return Pose{q, {2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.1 * std::sin(t)}};
}

Trajectory circle(double begin, double end, double step) {
  Trajectory path;
  const auto count = static_cast<long>(std::llround((end - begin) / step));
  for (long i = 0; i <= count; ++i) {
    const double t = begin + step * static_cast<double>(i);
    path.poses.push_back({from_seconds(t), on_circle(t)});
  }
  return path;
}

/// The same with a drift of 0.1 m/s along x, from `begin` on.
void add_drift(Trajectory& path, double begin) {
  for (StampedPose& pose : path.poses) {
    pose.T_w_f.p.x() += 0.1 * std::max(0.0, to_seconds(pose.t) - begin);
  }
}

Evaluation with(std::string_view recipe, const Trajectory& gt, const Trajectory& est) {
  return evaluate(recipe, {gt, est, RecipeOptions{}});
}

TEST(FalseZeroTrap, OnePosePer2500MsHasNoMotionOverOneSecond) {
  const Trajectory gt = circle(0, 50, 0.01);
  Trajectory est = circle(0, 50, 2.5);
  add_drift(est, 0);
  // Nearest to t + 1 s is the pose at t itself: every pair is of a pose with itself.
  const Evaluation tum = with("compat:tum", gt, est);
  ASSERT_TRUE(tum.rpe_m);
  EXPECT_NEAR(tum.rpe_m->rmse, 0.0, 1e-12);
  ASSERT_EQ(tum.notes.size(), 1u);
  EXPECT_NE(tum.notes[0].find("of a pose with itself"), std::string::npos);
  const Evaluation strict = with("strict:se3", gt, est);
  EXPECT_FALSE(strict.rpe_m);
  EXPECT_EQ(strict.notes.back(), "21 of 21 RPE starts have no pose at the right distance and were dropped");
  EXPECT_NEAR(*strict.coverage, 0.4, 1e-9);  // 20 poses stand 1 s each, of 50 s
}

TEST(GapTrap, AMotionOverAGapIsNoMotionOverOneSecond) {
  // Exact but for a jump of 1 m while blind from 20 to 25 s.
  const Trajectory gt = circle(0, 50, 0.01);
  Trajectory est = circle(0, 20, 0.1);
  Trajectory behind = circle(25, 50, 0.1);
  for (StampedPose& pose : behind.poses) pose.T_w_f.p.x() += 1.0;
  est.poses.insert(est.poses.end(), behind.poses.begin(), behind.poses.end());
  // Starts at 19.1 .. 19.9 s: nearest to t + 1 is 20.0 s, a shorter span; at 20.0 s the pose itself. None
  // crosses the gap, each dilutes the mean with a motion that is no motion over 1 s.
  const Evaluation tum = with("compat:tum", gt, est);
  EXPECT_NEAR(tum.rpe_m->rmse, 0.0, 1e-9);
  const Evaluation strict = with("strict:se3", gt, est);
  EXPECT_NEAR(strict.rpe_m->rmse, 0.0, 1e-9);
  EXPECT_EQ(tum.rpe_m->count - strict.rpe_m->count, 9u);  // 10 around the gap; one at the end TUM leaves out
  EXPECT_NEAR(*strict.coverage, 1.0 - 4.0 / 50.0, 1e-9);  // blind from 21 to 25 s
  EXPECT_GT(strict.ate_m->rmse, 0.1);                     // the jump shows where it can: in the ATE
  ASSERT_EQ(strict.lost.size(), 1u);
  EXPECT_NEAR(to_seconds(strict.lost[0].begin), 21.0, 1e-9);
}

TEST(LostTrackTrap, ARunThatEndsEarlyHasASmallErrorAndASmallCoverage) {
  const Trajectory gt = circle(0, 50, 0.01);
  Trajectory whole = circle(0, 50, 0.1);
  add_drift(whole, 5.0);
  Trajectory lost = circle(0, 5, 0.1);
  // The tool's number alone says that the lost run is the better one.
  EXPECT_LT(with("compat:tum", gt, lost).ate_m->rmse, 0.01 * with("compat:tum", gt, whole).ate_m->rmse);
  EXPECT_NEAR(*with("strict:se3", gt, lost).coverage, 6.0 / 50.0, 1e-9);  // 5 s and the hold of the last pose
  EXPECT_NEAR(*with("strict:se3", gt, whole).coverage, 1.0, 1e-9);
}

TEST(StrictRecipe, RefusesAnAlignmentThatTheDataLeaveOpen) {
  Trajectory line;
  for (int i = 0; i < 20; ++i)
    line.poses.push_back({Timestamp{i * 100'000'000LL}, Pose{.p = {0.1 * i, 0, 0}}});
  EXPECT_THROW(static_cast<void>(with("strict:se3", line, line)), std::runtime_error);
  EXPECT_NO_THROW(static_cast<void>(with("strict:first_pose", line, line)));
  EXPECT_NO_THROW(static_cast<void>(with("compat:tum", line, line)));
}

TEST(Recipes, EachHasATextAndAVersion) {
  for (const Recipe& recipe : recipes()) {
    EXPECT_GT(recipe.text.size(), 100u) << recipe.name;
    EXPECT_GE(recipe.version, 1) << recipe.name;
  }
  EXPECT_THROW(static_cast<void>(with("compat:none", {}, {})), std::runtime_error);
}

TEST(Recipes, SayNothingRatherThanZeroForEmptyInput) {
  for (const Recipe& recipe : recipes()) {
    const Evaluation empty = with(recipe.name, circle(0, 1, 0.1), {});
    EXPECT_FALSE(empty.ate_m) << recipe.name;
    EXPECT_FALSE(empty.rpe_m) << recipe.name;
    const Evaluation blind = with(recipe.name, {}, circle(0, 1, 0.1));
    EXPECT_FALSE(blind.ate_m) << recipe.name;
    EXPECT_FALSE(blind.coverage) << recipe.name;
  }
}

}  // namespace
}  // namespace stillpoint
