// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/pixel_noise.h"

#include <gtest/gtest.h>

#include "tests/support/window_world.h"

namespace stillpoint {
namespace {

constexpr double kFocal_px = 500.0;

BackendConfig watchful() {
  BackendConfig config;
  config.pixel_sigma_px = 1.5;
  config.pixel_misfit_px = 0.5;
  return config;
}

double sigma_after(const std::vector<double>& misfits, const BackendConfig& config) {
  PixelNoise noise;
  for (const double misfit : misfits) noise.observe(misfit, config);
  return noise.applied_to(config).pixel_sigma_px;
}

TEST(MedianMisfit, IsTheDistanceByWhichAllSightingsAreOff) {
  Window window = visual_window(4, 30);
  EXPECT_NEAR(MisfitMeter().median_px(window, kFocal_px), 0.0, 1e-9);
  for (Landmark& landmark : window.landmarks) {
    for (std::size_t i = 1; i < landmark.observations.size(); ++i) {
      landmark.observations[i].bearing += Eigen::Vector2d(3.0, 4.0) / kFocal_px;  // 5 px
    }
  }
  EXPECT_NEAR(MisfitMeter().median_px(window, kFocal_px), 5.0, 1e-9);
}

TEST(MedianMisfit, IsUnknownWithFewSightings) {
  EXPECT_EQ(MisfitMeter().median_px(visual_window(2, 19), kFocal_px), 0.0);
}

TEST(PixelNoise, StaysNominalUpToTheNominalMisfit) {
  EXPECT_DOUBLE_EQ(sigma_after(std::vector<double>(50, 0.4), watchful()), 1.5);
}

TEST(PixelNoise, GrowsWithTheSquareOfTheMisfitAndIsBounded) {
  // (0.75 / 0.5)^2 = 2.25, reached to 1 - 0.9^100; far beyond, 4 is the bound
  EXPECT_NEAR(sigma_after(std::vector<double>(100, 0.75), watchful()), 1.5 * 2.25, 1e-3);
  EXPECT_NEAR(sigma_after(std::vector<double>(100, 50.0), watchful()), 1.5 * 4.0, 1e-3);
}

TEST(PixelNoise, IsLeftAloneWhereTheMisfitIsUnknownOrTheSettingOff) {
  EXPECT_DOUBLE_EQ(sigma_after({0.0, 0.0}, watchful()), 1.5);
  BackendConfig off = watchful();
  off.pixel_misfit_px = 0.0;
  EXPECT_DOUBLE_EQ(sigma_after({5.0, 5.0}, off), 1.5);
}

}  // namespace
}  // namespace stillpoint
