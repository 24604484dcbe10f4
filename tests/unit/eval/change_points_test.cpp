// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/change_points.h"

#include <random>

#include <gtest/gtest.h>

namespace stillpoint::eval {
namespace {

/// Constant levels of `length` values each, with Gaussian noise of 0.01.
std::vector<double> levels(const std::vector<double>& means, std::size_t length, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<double> values;
  for (const double mean : means) {
    for (std::size_t i = 0; i < length; ++i) values.push_back(mean + noise(random));
  }
  return values;
}

TEST(ChangePoints, AreFoundWhereTheLevelChanges) {
  // Steps of 10 and 20 standard deviations are located exactly.
  const std::vector<ChangePoint> changes = change_points(levels({1.0, 1.1, 0.9}, 15));
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[0].index, 15u);
  EXPECT_EQ(changes[1].index, 30u);
  EXPECT_LE(changes[0].p_value, 0.005);
}

TEST(ChangePoints, AreNotFoundInEqualOrFewValues) {
  EXPECT_TRUE(change_points(std::vector<double>(50, 2.0)).empty());
  EXPECT_TRUE(change_points({}).empty());
  // Two of the 20 partitions of six values into two groups of three have the same divergence: p is about 0.1.
  EXPECT_TRUE(change_points(std::vector<double>{1, 1, 1, 2, 2, 2}).empty());
}

TEST(ChangePoints, AreNotFoundAtASingleOutlier) {
  std::vector<double> values = levels({1.0}, 50);
  values[25] = 2.0;
  EXPECT_TRUE(change_points(values).empty());
}

TEST(ChangePoints, AreFoundOnceAMinimumSegmentFollows) {
  std::vector<double> values = levels({1.0}, 60);
  for (const double late : {1.10, 1.11, 1.10}) values.push_back(late);
  const std::vector<ChangePoint> changes = change_points(values);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes.front().index, 60u);
}

TEST(ChangePoints, DoNotDependOnUnitOrOffset) {
  const std::vector<double> values = levels({1.0, 1.05}, 20);
  std::vector<double> scaled;
  for (const double value : values) scaled.push_back(8.0 * value - 3.0);
  const std::vector<ChangePoint> changes = change_points(values);
  const std::vector<ChangePoint> changes_scaled = change_points(scaled);
  ASSERT_EQ(changes.size(), 1u);
  ASSERT_EQ(changes_scaled.size(), 1u);
  EXPECT_EQ(changes.front().index, changes_scaled.front().index);
  EXPECT_EQ(changes.front().p_value, changes_scaled.front().p_value);
}

TEST(LevelChange, IsTheMedianRatioOfAllPairsOfValues) {
  // Ratios of (4, 8) to (1, 2): 4, 8, 2, 4. Four values do not support an interval.
  const std::optional<RelativeChange> change =
      level_change(std::vector<double>{1, 2}, std::vector<double>{4, 8});
  ASSERT_TRUE(change);
  EXPECT_NEAR(change->median, 3.0, 1e-12);
  EXPECT_EQ(change->count, 2u);
  EXPECT_FALSE(change->interval);
}

TEST(LevelChange, HasAnIntervalFromFourAndFourValuesOn) {
  // p = 2 / C(8, 4) = 0.0286; the interval spans the ratios 10 / 4 and 40 / 1.
  const std::optional<RelativeChange> change =
      level_change(std::vector<double>{1, 2, 3, 4}, std::vector<double>{10, 20, 30, 40});
  EXPECT_NEAR(change->p_value, 2.0 / 70.0, 1e-12);
  ASSERT_TRUE(change->interval);
  EXPECT_NEAR(change->interval->low, 1.5, 1e-12);
  EXPECT_NEAR(change->interval->high, 39.0, 1e-12);
  EXPECT_FALSE(level_change(std::vector<double>{1, 2, 3}, std::vector<double>{10, 20, 30})->interval);
}

TEST(LevelChange, IsNotAvailableFromZeroOrWithoutValues) {
  EXPECT_FALSE(level_change(std::vector<double>{0, 0}, std::vector<double>{1, 1}));
  EXPECT_FALSE(level_change({}, std::vector<double>{1}));
  EXPECT_EQ(level_change(std::vector<double>{0}, std::vector<double>{0})->median, 0.0);
}

TEST(Trend, RecoversTheSlopeOfALineWithAnOutlier) {
  std::vector<double> values;
  for (int i = 0; i < 21; ++i) values.push_back(5.0 + 0.5 * i);
  values[7] = 1000.0;
  const std::optional<Trend> trend = trend_of(values);
  ASSERT_TRUE(trend);
  EXPECT_DOUBLE_EQ(trend->slope, 0.5);
  EXPECT_DOUBLE_EQ(trend->intercept, 5.0);
  EXPECT_LT(trend->p_value, 1e-6);
}

TEST(Trend, HasTheMannKendallPValueOfFourValues) {
  // S of 4 increasing values is 6, its variance 4 * 3 * 13 / 18 = 26 / 3, z = 5 / 2.9439 = 1.6984, two-sided
  // p = 0.0894.
  EXPECT_NEAR(trend_of(std::vector<double>{1, 2, 3, 4})->p_value, 0.0894, 5e-4);
  EXPECT_FALSE(trend_of(std::vector<double>{1, 2, 3}));
}

TEST(Trend, FitsADriftBetterThanLevelsButNotAStep) {
  std::vector<double> drift;
  std::vector<double> step;
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.01);
  for (int i = 0; i < 60; ++i) {
    drift.push_back(1.0 + 0.002 * i + noise(random));
    step.push_back((i < 30 ? 1.0 : 1.12) + noise(random));
  }
  EXPECT_TRUE(linear_trend_fits_better(drift, *trend_of(drift), {30}));
  EXPECT_FALSE(linear_trend_fits_better(step, *trend_of(step), {30}));
}

}  // namespace
}  // namespace stillpoint::eval
