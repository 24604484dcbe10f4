// SPDX-License-Identifier: BSD-3-Clause
// Exact rank tests: published tables, examples derived by hand, and coverage by simulation.
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "eval/statistics/rank_tests.h"

namespace stillpoint::eval {
namespace {

std::vector<double> signed_rank_distribution(std::size_t n) {
  std::vector<std::size_t> ranks(n);
  std::iota(ranks.begin(), ranks.end(), 1);
  return sign_distribution(ranks);
}

TEST(SignedRank, HasTheCriticalValuesOfPublishedTables) {
  // Largest T with two-sided p <= 0.05 and 0.01: Wilcoxon and Wilcox, Some Rapid Approximate Statistical
  // Procedures, 1964, Table 2.
  struct Row {
    std::size_t n, at_5_percent;
  };
  for (const Row row : {Row{6, 0}, {7, 2}, {8, 3}, {9, 5}, {10, 8}, {15, 25}, {20, 52}, {25, 89}}) {
    const std::vector<double> distribution = signed_rank_distribution(row.n);
    EXPECT_LE(two_sided_p(distribution, row.at_5_percent), 0.05) << row.n;
    EXPECT_GT(two_sided_p(distribution, row.at_5_percent + 1), 0.05) << row.n;
  }
  for (const Row row : {Row{8, 0}, {9, 1}, {10, 3}}) {
    const std::vector<double> distribution = signed_rank_distribution(row.n);
    EXPECT_LE(two_sided_p(distribution, row.at_5_percent), 0.01) << row.n;
    EXPECT_GT(two_sided_p(distribution, row.at_5_percent + 1), 0.01) << row.n;
  }
}

TEST(SignedRank, CountsTheSubsetsOfSixRanks) {
  // Of the 64 subsets of {1 .. 6} the sums 0, 1, 2, 3 occur 1, 1, 1, 2 times.
  const std::vector<double> distribution = signed_rank_distribution(6);
  ASSERT_EQ(distribution.size(), 22u);
  EXPECT_DOUBLE_EQ(distribution[0], 1.0 / 64.0);
  EXPECT_DOUBLE_EQ(distribution[3], 2.0 / 64.0);
  EXPECT_DOUBLE_EQ(distribution[21], 1.0 / 64.0);
  EXPECT_DOUBLE_EQ(std::accumulate(distribution.begin(), distribution.end(), 0.0), 1.0);
}

TEST(SignedRank, OfSixPositiveDifferencesSpansThem) {
  const std::optional<SignedRank> test = signed_rank(std::vector<double>{1, 2, 3, 4, 5, 6});
  ASSERT_TRUE(test);
  EXPECT_EQ(test->count, 6u);
  EXPECT_DOUBLE_EQ(test->p_value, 2.0 / 64.0);
  EXPECT_DOUBLE_EQ(test->estimate, 3.5);  // symmetric about it
  ASSERT_TRUE(test->interval);
  EXPECT_EQ(test->interval->low, 1.0);
  EXPECT_EQ(test->interval->high, 6.0);
}

TEST(SignedRank, HasNoIntervalBelowItsSmallestCount) {
  EXPECT_FALSE(signed_rank(std::vector<double>{1, 2, 3, 4, 5})->interval);
  EXPECT_TRUE(signed_rank(std::vector<double>{1, 2, 3, 4, 5}, 0.90)->interval);
  EXPECT_FALSE(signed_rank(std::vector<double>{1, 2, 3, 4, 5, 6}, 0.99)->interval);
  EXPECT_FALSE(signed_rank({}));
}

TEST(SignedRank, UsesTheConditionalDistributionForTies) {
  // All ranks are 3.5 and T- = 3.5; 1 + 6 of 64 sign patterns have at most one negative sign: p = 14 / 64.
  EXPECT_DOUBLE_EQ(signed_rank(std::vector<double>{1, 1, 1, 1, 1, -1})->p_value, 14.0 / 64.0);
  // Ranks 1.5, 1.5, 3 and T- = 1.5: sums of at most 1.5 in 3 of 8 patterns.
  EXPECT_DOUBLE_EQ(signed_rank(std::vector<double>{1, -1, 2})->p_value, 6.0 / 8.0);
}

TEST(SignedRank, OmitsZerosFromThePValueButNotFromTheInterval) {
  // Six non-zero differences: p = 2 / 64. For n = 8 the interval is [w_(4), w_(33)]. Smallest means of two:
  // 0, 0, 0, 0.5 (of 0 and 1); largest: 6, 5.5, 5, 5.
  const std::optional<SignedRank> test = signed_rank(std::vector<double>{0, 0, 1, 2, 3, 4, 5, 6});
  EXPECT_DOUBLE_EQ(test->p_value, 2.0 / 64.0);
  EXPECT_EQ(test->interval->low, 0.5);
  EXPECT_EQ(test->interval->high, 5.0);
  EXPECT_DOUBLE_EQ(signed_rank(std::vector<double>(8, 0.0))->p_value, 1.0);
}

TEST(SignedRank, SmallestPHalvesWithEachPair) {
  EXPECT_EQ(smallest_p(0), 1.0);
  EXPECT_EQ(smallest_p(1), 1.0);
  EXPECT_EQ(smallest_p(5), 0.0625);
  EXPECT_EQ(smallest_count(0.05), 6u);
  EXPECT_EQ(smallest_count(0.0625), 5u);
  EXPECT_EQ(smallest_count(0.001), 11u);  // 2^-10 < 0.001 < 2^-9
}

/// Number of `samples` intervals that contain 0, of n differences with median 0.
template <typename Distribution>
int covering(std::size_t n, int samples, Distribution distribution) {
  std::mt19937_64 random(n);
  int covered = 0;
  for (int i = 0; i < samples; ++i) {
    std::vector<double> differences(n);
    for (double& difference : differences) difference = distribution(random);
    const Interval interval = *signed_rank(differences)->interval;
    covered += interval.low <= 0.0 && 0.0 <= interval.high ? 1 : 0;
  }
  return covered;
}

TEST(SignedRank, IntervalCoversTheMedianWithItsExactProbability) {
  constexpr int kSamples = 600;
  struct Row {
    std::size_t n, critical;  // critical value of the tables: the interval misses if T <= critical
  };
  for (const Row row : {Row{6, 0}, {10, 8}, {30, 137}}) {
    const double coverage = 1.0 - two_sided_p(signed_rank_distribution(row.n), row.critical);
    EXPECT_GE(coverage, 0.95);
    const double sigma = std::sqrt(coverage * (1.0 - coverage) * kSamples);
    EXPECT_NEAR(covering(row.n, kSamples, std::normal_distribution<double>()), coverage * kSamples,
                2.58 * sigma)
        << row.n;
    // Differences of -1, 0 and 1 have many ties, with which the coverage is larger.
    EXPECT_GE(covering(row.n, kSamples, std::uniform_int_distribution<int>(-1, 1)),
              coverage * kSamples - 2.58 * sigma)
        << row.n;
  }
}

TEST(MedianInterval, HasTheOrderStatisticsOfPublishedTables) {
  // Lower order statistic at 95 %: Conover, Practical Nonparametric Statistics, 1999, Sec. 3.2.
  struct Row {
    std::size_t n, k;
  };
  for (const Row row : {Row{6, 1}, {8, 1}, {9, 2}, {10, 2}, {12, 3}, {15, 4}, {20, 6}, {25, 8}}) {
    std::vector<double> values(row.n);
    std::iota(values.rbegin(), values.rend(), 1.0);  // x_(k) = k
    const std::optional<Interval> interval = median_interval(values);
    ASSERT_TRUE(interval);
    EXPECT_EQ(interval->low, static_cast<double>(row.k)) << row.n;
    EXPECT_EQ(interval->high, static_cast<double>(row.n + 1 - row.k)) << row.n;
  }
  EXPECT_FALSE(median_interval(std::vector<double>{1, 2, 3, 4, 5}));
  EXPECT_FALSE(median_interval({}));
}

TEST(MedianInterval, CoversTheMedianOfASkewedDistribution) {
  constexpr int kSamples = 1000;
  const double median = std::log(2.0);  // of the exponential distribution
  for (const std::size_t n : {6u, 10u, 30u}) {
    std::mt19937_64 random(n);
    std::exponential_distribution<double> distribution;
    int covered = 0;
    for (int i = 0; i < kSamples; ++i) {
      std::vector<double> values(n);
      for (double& value : values) value = distribution(random);
      const Interval interval = *median_interval(values);
      covered += interval.low <= median && median <= interval.high ? 1 : 0;
    }
    EXPECT_GE(covered, 0.95 * kSamples - 2.58 * std::sqrt(0.95 * 0.05 * kSamples)) << n;
  }
}

TEST(RankSum, HasTheCriticalValuesOfPublishedTables) {
  // Largest U with two-sided p <= 0.05: Auble, 1953, as in Siegel, Nonparametric Statistics, 1956, Table K.
  struct Row {
    std::size_t m, n, critical;
  };
  for (const Row row :
       {Row{4, 4, 0}, {3, 5, 0}, {5, 5, 2}, {6, 6, 5}, {5, 10, 8}, {10, 10, 23}, {20, 20, 127}}) {
    const std::vector<double> distribution = mann_whitney_distribution(row.m, row.n);
    EXPECT_LE(two_sided_p(distribution, row.critical), 0.05) << row.m << " " << row.n;
    EXPECT_GT(two_sided_p(distribution, row.critical + 1), 0.05) << row.m << " " << row.n;
  }
  EXPECT_GT(two_sided_p(mann_whitney_distribution(3, 4), 0), 0.05);
}

TEST(RankSum, CountsTheArrangementsOfThreeAndTwoValues) {
  // Of C(5, 2) = 10 arrangements, U = 0 .. 6 occurs 1, 1, 2, 2, 2, 1, 1 times.
  const std::vector<double> expected = {1, 1, 2, 2, 2, 1, 1};
  const std::vector<double> distribution = mann_whitney_distribution(3, 2);
  ASSERT_EQ(distribution.size(), expected.size());
  for (std::size_t u = 0; u < expected.size(); ++u) EXPECT_NEAR(distribution[u], expected[u] / 10.0, 1e-15);
}

TEST(RankSum, EstimatesTheShiftBetweenTwoSamples) {
  const std::vector<double> before = {1, 2, 3, 4};
  const std::vector<double> after = {11, 12, 13, 14};
  const std::optional<RankSum> test = rank_sum(before, after);
  EXPECT_EQ(test->shift, 10.0);
  EXPECT_NEAR(test->p_value, 2.0 / 70.0, 1e-15);
  EXPECT_EQ(test->interval->low, 7.0);
  EXPECT_EQ(test->interval->high, 13.0);
  EXPECT_NEAR(rank_sum(after, before)->p_value, 2.0 / 70.0, 1e-15);
  EXPECT_EQ(rank_sum(after, before)->shift, -10.0);
}

TEST(RankSum, CountsTiesAgainstADifference) {
  // Of 16 pairs one is equal: P(U <= 1) = 2 / 70.
  const std::vector<double> before = {1, 2, 3, 4};
  EXPECT_NEAR(rank_sum(before, std::vector<double>{4, 12, 13, 14})->p_value, 4.0 / 70.0, 1e-15);
  EXPECT_FALSE(rank_sum(before, {}));
}

}  // namespace
}  // namespace stillpoint::eval
