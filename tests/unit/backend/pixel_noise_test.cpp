// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/window/pixel_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/simulated/window_world.h"

namespace stillpoint {
namespace {

constexpr double kFocal_px = 500.0;

/// After many windows with this variance.
double settled_sigma_px(const ReprojectionVariance& variance, double scale) {
  PixelNoise noise(0.25, scale);
  for (int i = 0; i < 200; ++i) noise.observe(variance);
  return noise.sigma_px();
}

/// A long track of many landmarks, whose bearings have white noise.
Window noisy_window(double sigma_px) {
  Window window = visual_window(8, 400);
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, sigma_px / kFocal_px);
  for (Landmark& landmark : window.landmarks) {
    const Eigen::Vector2d of_host(normal(random), normal(random));
    for (std::size_t i = 1; i < landmark.observations.size(); ++i)
      landmark.observations[i].bearing += Eigen::Vector2d(normal(random), normal(random)) - of_host;
  }
  return window;
}

TEST(ReprojectionVariance, OfWhiteNoiseIsThatOfTheDifferenceOfTwoBearings) {
  const auto variance = ReprojectionErrorMonitor().measure(noisy_window(0.5), kFocal_px);
  ASSERT_TRUE(variance);
  EXPECT_NEAR(variance->white_px2, 2.0 * 0.5 * 0.5, 0.04);
  EXPECT_NEAR(variance->correlated_px2, 0.0, 0.04);
}

TEST(ReprojectionVariance, OfAConstantErrorIsCorrelated) {
  Window window = visual_window(4, 30);
  for (Landmark& landmark : window.landmarks) {
    for (std::size_t i = 1; i < landmark.observations.size(); ++i)
      landmark.observations[i].bearing += Eigen::Vector2d(3.0, 4.0) / kFocal_px;
  }
  const auto variance = ReprojectionErrorMonitor().measure(window, kFocal_px);
  ASSERT_TRUE(variance);
  EXPECT_NEAR(variance->white_px2, 0.0, 1e-9);
  EXPECT_NEAR(variance->correlated_px2, 25.0 / (2.0 * std::log(2.0)), 1e-6);
}

TEST(ReprojectionVariance, OfIndependentErrorsHasNoDesignEffect) {
  const auto variance = ReprojectionErrorMonitor().measure(noisy_window(0.5), kFocal_px);
  ASSERT_TRUE(variance);
  EXPECT_NEAR(variance->design_effect, 1.0, 3.0);  // 400 features with 145 neighbors each: 1 +- 1
}

TEST(ReprojectionVariance, OfErrorsOfTheWholeImageCountsTheNeighborsOfAFeature) {
  Window window = visual_window(4, 60);
  int neighbors = 0;
  for (Landmark& a : window.landmarks) {
    const Eigen::Vector2d bearing = a.observations.back().bearing;
    for (const Landmark& b : window.landmarks)
      neighbors += &a != &b && (b.observations.back().bearing - bearing).norm() < 0.4;
  }
  for (Landmark& landmark : window.landmarks)
    landmark.observations.back().bearing += Eigen::Vector2d(3.0, 4.0) / kFocal_px;
  const auto variance = ReprojectionErrorMonitor().measure(window, kFocal_px);
  ASSERT_TRUE(variance);
  EXPECT_GT(neighbors, 60);
  EXPECT_NEAR(variance->design_effect, 1.0 + neighbors / 60.0, 0.05);
}

TEST(ReprojectionVariance, IsUnknownWithTooFewObservations) {
  EXPECT_FALSE(ReprojectionErrorMonitor().measure(visual_window(2, 19), kFocal_px));
  EXPECT_FALSE(ReprojectionErrorMonitor().measure(visual_window(2, 40), kFocal_px)) << "no differences";
}

TEST(ReprojectionVariance, IgnoresErrorsThatAreNotFinite) {
  Window window = visual_window(4, 60);
  for (std::size_t k = 0; k < 60; k += 2)
    window.landmarks[k].observations[1].bearing.x() = std::numeric_limits<double>::quiet_NaN();
  const auto variance = ReprojectionErrorMonitor().measure(window, kFocal_px);
  ASSERT_TRUE(variance);
  EXPECT_NEAR(variance->white_px2 + variance->correlated_px2, 0.0, 1e-9);
}

TEST(PixelNoise, IsTheNominalOneAtTheStart) { EXPECT_EQ(PixelNoise(0.25, 1.0).sigma_px(), 0.25); }

TEST(PixelNoise, CountsModelErrorSixTimes) {
  EXPECT_NEAR(settled_sigma_px({.white_px2 = 0.5}, 1.0), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(settled_sigma_px({.white_px2 = 0.5, .correlated_px2 = 0.2}, 1.0), std::sqrt(1.7), 1e-6);
  EXPECT_NEAR(settled_sigma_px({.white_px2 = 0.5}, 4.0), 4.0 * std::sqrt(0.5), 1e-6);
}

TEST(PixelNoise, OfTheOptimizationContainsTheDesignEffect) {
  PixelNoise noise(0.25, 1.0);
  for (int i = 0; i < 200; ++i) noise.observe({.white_px2 = 0.5, .design_effect = 9.0});
  EXPECT_NEAR(noise.sigma_px(), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(noise.applied_to({}).pixel_sigma_px, 3.0 * std::sqrt(0.5), 1e-6);
  for (int i = 0; i < 200; ++i) noise.observe({.white_px2 = 0.5, .design_effect = 0.5});
  EXPECT_NEAR(noise.applied_to({}).pixel_sigma_px, std::sqrt(0.5), 1e-6) << "at least 1";
}

TEST(PixelNoise, LeavesTheRobustLossInPixels) {
  PixelNoise noise(0.25, 1.0);
  for (int i = 0; i < 200; ++i) noise.observe({.white_px2 = 0.5, .design_effect = 9.0});
  const BackendConfig config = noise.applied_to({.cauchy_scale = 0.5});
  EXPECT_NEAR(config.cauchy_scale * config.pixel_sigma_px, 0.5 * noise.sigma_px(), 1e-6);
}

TEST(PixelNoise, OfTheChangesIsThatOfTheWhitePart) {
  PixelNoise noise(0.25, 4.0);
  EXPECT_EQ(noise.white_px(), 0.25);
  for (int i = 0; i < 200; ++i) noise.observe({.white_px2 = 0.5, .correlated_px2 = 0.2});
  EXPECT_NEAR(noise.white_px(), std::sqrt(0.5), 1e-6);
}

TEST(PixelNoise, IsBounded) {
  EXPECT_NEAR(settled_sigma_px({.white_px2 = 1e-6}, 1.0), 0.09, 1e-6);
  EXPECT_NEAR(settled_sigma_px({.white_px2 = 1e4}, 1.0), 9.0, 1e-6);
}

TEST(PixelNoise, IsAtLeastTheNominalOneIfErrorsAreExpected) {
  PixelNoise noise(0.25, 1.0);
  for (int i = 0; i < 100; ++i) noise.observe({.white_px2 = 0.01});
  EXPECT_LT(noise.sigma_px(), 0.11);
  noise.expect_errors();
  EXPECT_EQ(noise.sigma_px(), 0.25);
}

}  // namespace
}  // namespace stillpoint
