// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "eval/statistics/rank_tests.h"

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

TEST(Spread, HasNoIntervalForFewerThanSixValues) {
  EXPECT_FALSE(spread(std::vector<double>{1.0})->median_interval);
  EXPECT_FALSE(spread(std::vector<double>{1.0, 2.0, 3.0, 4.0, 5.0})->median_interval);
  EXPECT_TRUE(spread(std::vector<double>{1.0, 2.0, 3.0, 4.0, 5.0, 6.0})->median_interval);
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

TEST(PairedDifference, IsSignificantOnlyFromSixPairsOn) {
  // All pairs increase: p = 2 / 2^n, which is 0.0625 for 5 pairs and 0.03125 for 6.
  std::vector<Pair> pairs;
  for (int i = 1; i <= 5; ++i) pairs.push_back({1.0, 1.0 + 0.1 * i});
  EXPECT_FALSE(is_significant(*paired_difference(pairs)));
  EXPECT_FALSE(is_significant(*relative_change(pairs)));
  EXPECT_DOUBLE_EQ(paired_difference(pairs)->p_value, 0.0625);
  pairs.push_back({1.0, 1.6});
  EXPECT_TRUE(is_significant(*paired_difference(pairs)));
  EXPECT_TRUE(is_significant(*relative_change(pairs)));
  EXPECT_DOUBLE_EQ(relative_change(pairs)->p_value, 0.03125);
}

TEST(RelativeChange, IsThePseudomedianRatioMinusOne) {
  // Ratios 2, 8, 2; means of two logarithms base 2: 1, 2, 1, 3, 2, 1; their median is 1.5: 2^1.5 - 1.
  const std::vector<Pair> pairs = {{10.0, 20.0}, {3.0, 24.0}, {5.0, 10.0}};
  EXPECT_NEAR(relative_change(pairs)->median, std::pow(2.0, 1.5) - 1.0, 1e-12);
}

TEST(RelativeChange, IsZeroIfAFactorAndItsInverseCompensate) {
  const std::vector<Pair> pairs = {{10.0, 20.0}, {20.0, 10.0}};
  EXPECT_NEAR(relative_change(pairs)->median, 0.0, 1e-12);
}

TEST(RelativeChange, HasTheSignOfTheDifferenceForNegativeValues) {
  const std::vector<Pair> pairs = {{-2.0, -1.0}};  // increases by half of |-2|
  EXPECT_DOUBLE_EQ(relative_change(pairs)->median, 0.5);
}

TEST(RelativeChange, OfAValueThatBecomesZeroIsMinusOne) {
  const std::vector<Pair> pairs = {{4.0, 0.0}};
  EXPECT_DOUBLE_EQ(relative_change(pairs)->median, -1.0);
}

TEST(RelativeChange, ExcludesPairsWithBaseZero) {
  const std::vector<Pair> pairs = {{0.0, 1.0}, {0.0, 0.0}};
  EXPECT_EQ(relative_change(pairs)->count, 1u);
  EXPECT_EQ(relative_change(pairs)->median, 0.0);
}

}  // namespace
}  // namespace stillpoint::eval
