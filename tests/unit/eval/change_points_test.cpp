// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/change_points.h"

#include <random>

#include <gtest/gtest.h>

#include "eval/statistics/level.h"

namespace stillpoint {
namespace {

/// Levels with noise of 0.01, `length` values each.
std::vector<double> levels(const std::vector<double>& means, std::size_t length, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<double> values;
  for (const double mean : means) {
    for (std::size_t i = 0; i < length; ++i) values.push_back(mean + noise(random));
  }
  return values;
}

TEST(ChangePoints, AreWhereTheLevelChanges) {
  // Steps of 10 and 20 standard deviations: nothing but their very places divides so well.
  const std::vector<ChangePoint> changes = change_points(levels({1.0, 1.1, 0.9}, 15));
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[0].index, 15u);
  EXPECT_EQ(changes[1].index, 30u);
  EXPECT_LE(changes[0].p_value, 0.005);
}

TEST(ChangePoints, AreNoneInEqualOrFewValues) {
  EXPECT_TRUE(change_points(std::vector<double>(50, 2.0)).empty());
  EXPECT_TRUE(change_points({}).empty());
  // Of the 20 ways to divide six values into three and three, two divide these as well: p is about 0.1.
  EXPECT_TRUE(change_points(std::vector<double>{1, 1, 1, 2, 2, 2}).empty());
}

TEST(ChangePoints, AOneOffIsShorterThanASegment) {
  std::vector<double> values = levels({1.0}, 50);
  values[25] = 2.0;
  EXPECT_TRUE(change_points(values).empty());
}

TEST(ChangePoints, AreFoundWhenASegmentOfValuesIsBehindThem) {
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
  const std::vector<ChangePoint> others = change_points(scaled);
  ASSERT_EQ(changes.size(), 1u);
  ASSERT_EQ(others.size(), 1u);
  EXPECT_EQ(changes.front().index, others.front().index);
  EXPECT_EQ(changes.front().p_value, others.front().p_value);
}

TEST(LevelChange, IsThatOfMediansWithItsInterval) {
  // Medians 2 and 3: 3 / 2 - 1. The extremes of what resampling can give: 2 / 3 - 1 and 4 / 1 - 1.
  const std::optional<RelativeChange> change =
      level_change(std::vector<double>{1, 2, 3}, std::vector<double>{2, 3, 4});
  ASSERT_TRUE(change);
  EXPECT_DOUBLE_EQ(change->median, 0.5);
  EXPECT_EQ(change->count, 3u);
  EXPECT_GE(change->interval.low, 2.0 / 3.0 - 1.0);
  EXPECT_LE(change->interval.high, 3.0);
  EXPECT_LT(change->interval.low, change->interval.high);
}

TEST(LevelChange, FromNothingHasNoRatio) {
  EXPECT_FALSE(level_change(std::vector<double>{0, 0}, std::vector<double>{1, 1}));
  EXPECT_FALSE(level_change({}, std::vector<double>{1}));
  EXPECT_EQ(level_change(std::vector<double>{0}, std::vector<double>{0})->median, 0.0);
}

TEST(Trend, HasTheSlopeOfALineWhateverItsOutliers) {
  std::vector<double> values;
  for (int i = 0; i < 21; ++i) values.push_back(5.0 + 0.5 * i);
  values[7] = 1000.0;
  const std::optional<Trend> trend = trend_of(values);
  ASSERT_TRUE(trend);
  EXPECT_DOUBLE_EQ(trend->slope, 0.5);
  EXPECT_DOUBLE_EQ(trend->start, 5.0);
  EXPECT_LT(trend->p_value, 1e-6);
}

TEST(Trend, OfFourValuesHasTheKnownProbability) {
  // Kendall's S of an ordered list of 4 is 6, its variance 4 * 3 * 13 / 18 = 26 / 3, z = 5 / 2.9439 = 1.6984:
  // two-sided 0.0894.
  EXPECT_NEAR(trend_of(std::vector<double>{1, 2, 3, 4})->p_value, 0.0894, 5e-4);
  EXPECT_FALSE(trend_of(std::vector<double>{1, 2, 3}));
}

TEST(Trend, ALineFitsACreepAndLevelsFitAStep) {
  std::vector<double> creep;
  std::vector<double> step;
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.01);
  for (int i = 0; i < 60; ++i) {
    creep.push_back(1.0 + 0.002 * i + noise(random));
    step.push_back((i < 30 ? 1.0 : 1.12) + noise(random));
  }
  EXPECT_TRUE(line_fits_better(creep, *trend_of(creep), {30}));
  EXPECT_FALSE(line_fits_better(step, *trend_of(step), {30}));
}

}  // namespace
}  // namespace stillpoint
