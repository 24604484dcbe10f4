// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/frame_to_frame_error.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace stillpoint::eval {
namespace {

constexpr double kHalfPi = 1.5707963267948966;

MatchedPose at(double true_x, double x) {
  return {.t = {}, .gt = Pose{.p = {true_x, 0.0, 0.0}}, .est = Pose{.p = {x, 0.0, 0.0}}};
}

TEST(FrameToFrameError, IsTheErrorOfTheMotionAndNotOfThePosition) {
  FrameToFrameError error;
  EXPECT_TRUE(std::isnan(error.next(at(0.0, 5.0))));
  EXPECT_DOUBLE_EQ(error.next(at(1.0, 6.0)), 0.0);  // constant error of 5 m
  EXPECT_DOUBLE_EQ(error.next(at(2.0, 7.5)), 0.5);  // estimated motion 1.5 m, true motion 1 m
}

TEST(FrameToFrameError, DoesNotDependOnTheAlignment) {
  // The world frame of the estimate is rotated by 90 deg about z.
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(kHalfPi, Eigen::Vector3d::UnitZ()));
  FrameToFrameError error;
  static_cast<void>(error.next(MatchedPose{.t = {}, .gt = {}, .est = {.q = turn}}));
  const MatchedPose next{.t = {}, .gt = {.p = {1.0, 0.0, 0.0}}, .est = {.q = turn, .p = {0.0, 1.0, 0.0}}};
  EXPECT_NEAR(error.next(next), 0.0, 1e-12);
}

TEST(FrameToFrameError, IsInfiniteAtTheFirstFrameAfterTrackingIsLost) {
  FrameToFrameError error;
  static_cast<void>(error.next(at(0.0, 0.0)));
  EXPECT_EQ(error.next(std::nullopt), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(error.next(std::nullopt)));
  EXPECT_TRUE(std::isnan(error.next(at(1.0, 9.0))));  // the previous frame has no pose
}

TEST(WorstFrames, ContainsTheLargestValuesInDecreasingOrder) {
  WorstFrames worst(2);
  EXPECT_TRUE(worst.insert(10, 0.1).inserted);
  EXPECT_TRUE(worst.insert(11, 0.3).inserted);
  const WorstFrames::Insertion insertion = worst.insert(12, 0.2);
  EXPECT_TRUE(insertion.inserted);
  EXPECT_EQ(insertion.evicted, 10U);
  EXPECT_FALSE(worst.insert(13, 0.1).inserted);
  EXPECT_EQ(worst.frames(), (std::vector<std::size_t>{11, 12}));
}

TEST(WorstFrames, PrefersTheEarlierFrameAmongEqualValues) {
  WorstFrames worst(1);
  static_cast<void>(worst.insert(3, 0.5));
  EXPECT_FALSE(worst.insert(4, 0.5).inserted);
}

TEST(WorstFrames, IgnoresNanAndCanHaveZeroCapacity) {
  EXPECT_FALSE(WorstFrames(1).insert(0, std::numeric_limits<double>::quiet_NaN()).inserted);
  EXPECT_FALSE(WorstFrames(0).insert(0, 1.0).inserted);
}

}  // namespace
}  // namespace stillpoint::eval
