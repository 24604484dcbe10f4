// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace stillpoint::eval {
namespace {

/// `count` lognormal values with this deviation of the logarithm; `other` of three have `factor` times the
/// value.
std::vector<double> sample(std::mt19937_64& random, std::size_t count, double sigma, double factor = 1.0) {
  std::normal_distribution<double> normal(0.0, sigma);
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(0.01 * std::exp(normal(random)) * (i % 3 == 0 ? factor : 1.0));
  return values;
}

/// Fraction of 2,000 samples that have more than one mode.
double multimodal_fraction(std::size_t count, double sigma, double factor = 1.0) {
  std::mt19937_64 random(17);
  int found = 0;
  for (int i = 0; i < 2000; ++i) found += *mode_count(sample(random, count, sigma, factor)) > 1 ? 1 : 0;
  return found / 2000.0;
}

TEST(ModeCount, OneModeIsCalledSeveralInAtMostFivePercent) {
  // 2,000 samples: 5 % +- .5 %; the limit is three deviations above.
  for (const std::size_t count : {5, 6, 7, 8, 9, 11, 14, 19, 29, 39, 60}) {
    for (const double sigma : {0.05, 0.2, 1.0})
      EXPECT_LE(multimodal_fraction(count, sigma), 0.065) << count << " values, sigma " << sigma;
  }
}

TEST(ModeCount, TwoModesOfAFactorOfThreeAreFound) {
  EXPECT_GE(multimodal_fraction(6, 0.1, 3.0), 0.6);
  EXPECT_GE(multimodal_fraction(10, 0.1, 3.0), 0.9);
  EXPECT_GE(multimodal_fraction(20, 0.1, 3.0), 0.99);
}

TEST(ModeCount, CountsThreeModes) {
  const std::vector<double> values = {0.010,  0.011,  0.012, 0.0105, 0.0115, 0.040, 0.042, 0.041,
                                      0.0405, 0.0415, 0.160, 0.162,  0.161,  0.165, 0.166};
  EXPECT_EQ(mode_count(values), 3U);
}

TEST(ModeCount, OneValueFarFromTheOthersIsNoMode) {
  EXPECT_EQ(mode_count(std::vector<double>{0.010, 0.011, 0.0105, 0.0112, 0.0108, 0.0109, 1.0}), 1U);
}

TEST(ModeCount, GroupsThatDifferByLessThanTenPercentAreOneMode) {
  EXPECT_EQ(mode_count(std::vector<double>{1.0, 1.0, 1.0, 1.05, 1.05, 1.05}), 1U);
  EXPECT_EQ(mode_count(std::vector<double>{1.0, 1.0, 1.0, 1.15, 1.15, 1.15}), 2U);
}

TEST(ModeCount, IsNotAvailableForFewValuesOrValuesThatAreNotPositive) {
  EXPECT_FALSE(mode_count(std::vector<double>{1.0, 1.0, 3.0, 3.0}));
  EXPECT_FALSE(mode_count(std::vector<double>{0.0, 1.0, 1.0, 3.0, 3.0, 3.0}));
}

}  // namespace
}  // namespace stillpoint::eval
