// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/loop_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace stillpoint::eval {
namespace {

using ErrorAt = std::function<double(double t_s)>;

/// 30 s at 10 Hz along a parabola, off by `error_m` in z.
Trajectory parabola(const ErrorAt& error_m) {
  Trajectory trajectory{"camera", {}};
  for (int i = 0; i < 300; ++i) {
    const double t = 0.1 * i;
    trajectory.poses.push_back(
        {from_seconds(t), {Eigen::Quaterniond::Identity(), {t, 0.1 * t * t, error_m(t)}}});
  }
  return trajectory;
}

const ErrorAt kNoError = [](double) { return 0.0; };

/// Nothing in the first 10 s, then `before`, and `after` from 21 s on.
ErrorAt steps(double before, double after) {
  return [=](double t) { return t < 9.95 ? 0.0 : t < 20.95 ? before : after; };
}

TEST(ErrorAfterLoop, IsThatOfTheFramesFromOneSecondAfterTheFirstLoopOn) {
  const auto error = error_after_loop(parabola(kNoError), parabola(steps(0.2, 0.3)),
                                      parabola(steps(0.2, 0.1)), from_seconds(20.0));
  ASSERT_TRUE(error.has_value());
  // The alignment over the exact first 10 s is the identity: the errors are the steps after 21 s.
  EXPECT_NEAR(error->odometry_m, 0.3, 1e-9);
  EXPECT_NEAR(error->causal_m, 0.1, 1e-9);
  EXPECT_NEAR(error->ratio.value(), 1.0 / 3.0, 1e-9);
}

TEST(ErrorAfterLoop, IsTheRootMeanSquare) {
  // From 21 s to 25 s exclusive 40 frames with 0.3 m, then 50 frames with 0.6 m:
  // sqrt((40 0.09 + 50 0.36) / 90) = sqrt(0.24).
  const auto error = error_after_loop(parabola(kNoError), parabola([](double t) {
                                        return t < 9.95 ? 0.0 : t < 24.95 ? 0.3 : 0.6;
                                      }),
                                      parabola(kNoError), from_seconds(20.0));
  ASSERT_TRUE(error.has_value());
  EXPECT_NEAR(error->odometry_m, std::sqrt(0.24), 1e-9);
  EXPECT_NEAR(error->causal_m, 0.0, 1e-9);
}

TEST(ErrorAfterLoop, AlignsOnTheFramesBeforeALoopInTheFirstTenSeconds) {
  // The first loop is at 5 s. The odometry is off by 0.3 m from there on: frames from 5 s to 10 s in the
  // alignment would move it towards the middle.
  const ErrorAt odometry = [](double t) { return t < 4.95 ? 0.0 : 0.3; };
  const auto error =
      error_after_loop(parabola(kNoError), parabola(odometry), parabola(kNoError), from_seconds(5.0));
  ASSERT_TRUE(error.has_value());
  EXPECT_NEAR(error->odometry_m, 0.3, 1e-9);
}

TEST(ErrorAfterLoop, LeavesOutFramesThatOneTrajectoryLacks) {
  // The odometry ends at 25 s; the causal trajectory is off by 5 m afterwards.
  Trajectory odometry = parabola(steps(0.2, 0.3));
  odometry.poses.resize(250);
  const auto error =
      error_after_loop(parabola(kNoError), odometry, parabola([](double t) { return t < 24.95 ? 0.0 : 5.0; }),
                       from_seconds(20.0));
  ASSERT_TRUE(error.has_value());
  EXPECT_NEAR(error->causal_m, 0.0, 1e-9);
}

TEST(ErrorAfterLoop, IsAbsentWithoutFramesAfterTheLoop) {
  EXPECT_FALSE(
      error_after_loop(parabola(kNoError), parabola(kNoError), parabola(kNoError), from_seconds(29.5)));
}

TEST(ErrorAfterLoop, IsAbsentIfTheStartDoesNotDetermineTheAlignment) {
  // One frame before the loop.
  EXPECT_FALSE(
      error_after_loop(parabola(kNoError), parabola(kNoError), parabola(kNoError), from_seconds(0.05)));
}

}  // namespace
}  // namespace stillpoint::eval
