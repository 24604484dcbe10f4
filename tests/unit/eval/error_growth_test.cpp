// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/error_growth.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

constexpr double kQuarterTurn = 1.5707963267948966;

MatchedPose at(double true_x, double x) {
  return {.t = {}, .gt = Pose{.p = {true_x, 0.0, 0.0}}, .est = Pose{.p = {x, 0.0, 0.0}}};
}

TEST(ErrorGrowth, IsTheErrorOfTheMotionAndNotOfThePlace) {
  ErrorGrowth growth;
  EXPECT_TRUE(std::isnan(growth.next(at(0.0, 5.0))));
  EXPECT_DOUBLE_EQ(growth.next(at(1.0, 6.0)), 0.0);  // 5 m off as before
  EXPECT_DOUBLE_EQ(growth.next(at(2.0, 7.5)), 0.5);  // moved 1.5 m where 1 m is true
}

TEST(ErrorGrowth, KnowsNoAlignment) {
  // The estimate's world is turned by 90 deg about z: its x is the true y.
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(kQuarterTurn, Eigen::Vector3d::UnitZ()));
  ErrorGrowth growth;
  static_cast<void>(growth.next(MatchedPose{.t = {}, .gt = {}, .est = {.q = turn}}));
  const MatchedPose next{.t = {}, .gt = {.p = {1.0, 0.0, 0.0}}, .est = {.q = turn, .p = {0.0, 1.0, 0.0}}};
  EXPECT_NEAR(growth.next(next), 0.0, 1e-12);
}

TEST(ErrorGrowth, IsInfiniteWhereThePoseIsLostAndSaysSoOnce) {
  ErrorGrowth growth;
  static_cast<void>(growth.next(at(0.0, 0.0)));
  EXPECT_EQ(growth.next(std::nullopt), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(growth.next(std::nullopt)));
  EXPECT_TRUE(std::isnan(growth.next(at(1.0, 9.0))));  // nothing to count its motion from
}

TEST(WorstFrames, KeepsTheLargestValuesWorstFirst) {
  WorstFrames worst(2);
  EXPECT_TRUE(worst.offer(10, 0.1).is_taken);
  EXPECT_TRUE(worst.offer(11, 0.3).is_taken);
  const WorstFrames::Answer answer = worst.offer(12, 0.2);
  EXPECT_TRUE(answer.is_taken);
  EXPECT_EQ(answer.dropped, 10U);
  EXPECT_FALSE(worst.offer(13, 0.1).is_taken);
  EXPECT_EQ(worst.frames(), (std::vector<std::size_t>{11, 12}));
}

TEST(WorstFrames, PrefersTheEarlierOfEqualValues) {
  WorstFrames worst(1);
  static_cast<void>(worst.offer(3, 0.5));
  EXPECT_FALSE(worst.offer(4, 0.5).is_taken);
}

TEST(WorstFrames, TakesNoNanAndNothingWithoutRoom) {
  EXPECT_FALSE(WorstFrames(1).offer(0, std::numeric_limits<double>::quiet_NaN()).is_taken);
  EXPECT_FALSE(WorstFrames(0).offer(0, 1.0).is_taken);
}

}  // namespace
}  // namespace stillpoint
