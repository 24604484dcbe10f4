// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/window/pixel_noise.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/simulated/window_world.h"

namespace stillpoint {
namespace {

constexpr double kFocal_px = 500.0;

BackendConfig adaptive_config() {
  BackendConfig config;
  config.pixel_sigma_px = 1.5;
  config.reprojection_error_px = 0.5;
  return config;
}

double sigma_after(const std::vector<double>& errors_px, const BackendConfig& config) {
  PixelNoise noise;
  for (const double error_px : errors_px) noise.observe(error_px, config);
  return noise.applied_to(config).pixel_sigma_px;
}

TEST(MedianReprojectionError, EqualsACommonErrorOfAllObservations) {
  Window window = visual_window(4, 30);
  EXPECT_NEAR(ReprojectionErrorMonitor().median_px(window, kFocal_px), 0.0, 1e-9);
  for (Landmark& landmark : window.landmarks) {
    for (std::size_t i = 1; i < landmark.observations.size(); ++i) {
      landmark.observations[i].bearing += Eigen::Vector2d(3.0, 4.0) / kFocal_px;  // 5 px
    }
  }
  EXPECT_NEAR(ReprojectionErrorMonitor().median_px(window, kFocal_px), 5.0, 1e-9);
}

TEST(MedianReprojectionError, IsZeroWithTooFewObservations) {
  EXPECT_EQ(ReprojectionErrorMonitor().median_px(visual_window(2, 19), kFocal_px), 0.0);
}

TEST(MedianReprojectionError, IsThatOfTheFiniteErrors) {
  Window window = visual_window(4, 60);
  for (std::size_t k = 0; k < 60; k += 2)
    window.landmarks[k].observations[1].bearing.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(ReprojectionErrorMonitor().median_px(window, kFocal_px), 0.0, 1e-9);
}

TEST(PixelNoise, IgnoresAnErrorThatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(sigma_after({nan, 0.4}, adaptive_config()), 1.5, 1e-9);
}

TEST(PixelNoise, StaysNominalUpToTheNominalReprojectionErrorByDefault) {
  EXPECT_DOUBLE_EQ(sigma_after(std::vector<double>(50, 0.4), adaptive_config()), 1.5);
}

TEST(PixelNoise, DecreasesWithTheSquareOfTheErrorDownToItsBound) {
  BackendConfig config = adaptive_config();
  config.min_pixel_noise_factor = 0.5;
  EXPECT_NEAR(sigma_after(std::vector<double>(100, 0.4), config), 1.5 * 0.64, 1e-3);
  EXPECT_NEAR(sigma_after(std::vector<double>(100, 0.1), config), 1.5 * 0.5, 1e-3);
}

TEST(PixelNoise, IsNominalAgainIfErrorsAreExpected) {
  BackendConfig config = adaptive_config();
  config.min_pixel_noise_factor = 0.5;
  PixelNoise noise;
  for (int i = 0; i < 100; ++i) noise.observe(0.1, config);
  noise.expect_errors();
  EXPECT_DOUBLE_EQ(noise.applied_to(config).pixel_sigma_px, 1.5);
  for (int i = 0; i < 100; ++i) noise.observe(0.75, config);
  noise.expect_errors();
  EXPECT_NEAR(noise.applied_to(config).pixel_sigma_px, 1.5 * 2.25, 1e-3);
}

TEST(PixelNoise, GrowsWithTheSquareOfTheErrorUpToABound) {
  // (0.75 / 0.5)^2 = 2.25, up to 0.9^100; the upper bound is 4
  EXPECT_NEAR(sigma_after(std::vector<double>(100, 0.75), adaptive_config()), 1.5 * 2.25, 1e-3);
  EXPECT_NEAR(sigma_after(std::vector<double>(100, 50.0), adaptive_config()), 1.5 * 4.0, 1e-3);
}

TEST(PixelNoise, IsUnchangedIfTheErrorIsUnknownOrTheOptionIsOff) {
  EXPECT_DOUBLE_EQ(sigma_after({0.0, 0.0}, adaptive_config()), 1.5);
  BackendConfig off = adaptive_config();
  off.reprojection_error_px = 0.0;
  EXPECT_DOUBLE_EQ(sigma_after({5.0, 5.0}, off), 1.5);
}

}  // namespace
}  // namespace stillpoint
