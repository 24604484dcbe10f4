// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "eval/statistics/paired.h"

namespace stillpoint::eval {
namespace {

TEST(Spread, HasTheMedianTheQuartilesAndTheWorstValue) {
  // Ordered: 1 2 3 4 100. Median 3, quartiles at ranks 1 and 3: 2 and 4. The outlier affects only the worst
  // value.
  const std::vector<double> values = {4.0, 1.0, 100.0, 3.0, 2.0};
  const std::optional<Spread> result = spread(values);
  ASSERT_TRUE(result);
  EXPECT_EQ(result->count, 5u);
  EXPECT_EQ(result->median, 3.0);
  EXPECT_EQ(result->quartiles.low, 2.0);
  EXPECT_EQ(result->quartiles.high, 4.0);
  EXPECT_EQ(result->worst, 100.0);
}

TEST(Spread, IsNotAvailableWithoutValues) { EXPECT_FALSE(spread({})); }

TEST(MedianInterval, HasZeroWidthForEqualValues) {
  const std::vector<double> values(8, 2.5);
  EXPECT_EQ(median_interval(values)->low, 2.5);
  EXPECT_EQ(median_interval(values)->high, 2.5);
}

TEST(MedianInterval, CoversTheTrueMedianWithItsConfidence) {
  // 400 samples of 25 normal numbers; the true median is 0. The standard deviation of a coverage of 0.95 is
  // sqrt(0.95 * 0.05 / 400) = 0.011. The tolerance is about 4 of these plus the small bias of the percentile
  // interval.
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  int covered = 0;
  for (int i = 0; i < 400; ++i) {
    std::vector<double> values(25);
    for (double& value : values) value = normal(random);
    const Interval interval = *median_interval(values, {.resamples = 400});
    covered += interval.low <= 0.0 && 0.0 <= interval.high ? 1 : 0;
  }
  EXPECT_NEAR(covered / 400.0, 0.95, 0.05);
}

TEST(PairedDifference, HasEffectOneWhenEveryPairIncreases) {
  const std::vector<Pair> pairs = {{1.0, 1.1}, {5.0, 5.2}, {3.0, 3.3}};
  const std::optional<PairedDifference> result = paired_difference(pairs);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->median, 0.2, 1e-12);
  EXPECT_EQ(result->effect, 1.0);
}

TEST(PairedDifference, SubtractsTheRanksOfDecreasesFromThoseOfIncreases) {
  // Differences 1, -2, 3, 0: ranks 1, 2, 3 (0 has none); (1 + 3 - 2) / 6 = 1/3.
  const std::vector<Pair> pairs = {{0.0, 1.0}, {0.0, -2.0}, {0.0, 3.0}, {4.0, 4.0}};
  EXPECT_NEAR(paired_difference(pairs)->effect, 1.0 / 3.0, 1e-12);
}

TEST(PairedDifference, AssignsTheMeanRankToTies) {
  // Differences 1, -1, 2: ranks 1.5, 1.5, 3; (1.5 - 1.5 + 3) / 6 = 0.5.
  const std::vector<Pair> pairs = {{0.0, 1.0}, {0.0, -1.0}, {0.0, 2.0}};
  EXPECT_NEAR(paired_difference(pairs)->effect, 0.5, 1e-12);
}

TEST(RelativeChange, IsTheMedianRatioMinusOne) {
  const std::vector<Pair> pairs = {{10.0, 10.5}, {20.0, 22.0}, {4.0, 4.4}};  // 5 %, 10 %, 10 %
  EXPECT_NEAR(relative_change(pairs)->median, 0.1, 1e-12);
}

TEST(RelativeChange, ExcludesPairsWithBaseZero) {
  const std::vector<Pair> pairs = {{0.0, 1.0}, {0.0, 0.0}};
  EXPECT_EQ(relative_change(pairs)->count, 1u);
  EXPECT_EQ(relative_change(pairs)->median, 0.0);
}

}  // namespace
}  // namespace stillpoint::eval
