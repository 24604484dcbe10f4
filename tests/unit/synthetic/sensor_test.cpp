// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "datasets/synthetic/sensors/sensor_models.h"

namespace stillpoint::synth {
namespace {

constexpr int kWidth = 320, kHeight = 240;

Camera camera() {
  return {.width = kWidth, .height = kHeight, .fx = 300.0, .fy = 300.0, .cx = 159.5, .cy = 119.5};
}

RenderedFrame flat_frame(float radiance) {
  RenderedFrame frame{kWidth, kHeight, {}, {}, {}};
  frame.radiance.assign(kWidth * kHeight, Float4{radiance, radiance, radiance, 0.0F});
  return frame;
}

struct Statistics {
  double mean, deviation;
};

Statistics statistics(const cv::Mat& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation, image.channels() == 1 ? cv::Mat(image != 0) : cv::Mat());
  return {mean[0], deviation[0]};
}

TEST(ColorSensor, NoiseFollowsThePhotonTransferModel) {
  const ColorSensor sensor{.read_noise = 0.01, .shot_noise = 4e-4, .vignetting = 0.0};
  const Statistics measured = statistics(simulate_color(flat_frame(0.25F), camera(), sensor, {1.0, 5}));
  // sqrt(0.25) * 255 = 127.5. Noise of the signal: sqrt(0.01^2 + 4e-4 * 0.25) = 0.01414; the root's slope is
  // 255 / (2 sqrt(0.25)) = 255: 3.61 grey levels, and 1/12 of rounding under the root: 3.62.
  EXPECT_NEAR(measured.mean, 127.5, 0.3);
  EXPECT_NEAR(measured.deviation, 3.62, 0.08);
}

TEST(ColorSensor, VignettingFollowsCosFour) {
  const ColorSensor sensor{.read_noise = 0.0, .shot_noise = 0.0, .vignetting = 1.0};
  const cv::Mat image = simulate_color(flat_frame(0.5F), camera(), sensor, {1.0, 5});
  // At the corner tan^2 = (159.5^2 + 119.5^2) / 300^2 = 0.4413; cos^4 = 1 / 1.4413^2 = 0.4814;
  // 255 * sqrt(0.5 * 0.4814) = 125.1, in the center 255 * sqrt(0.5) = 180.3.
  EXPECT_NEAR(image.at<cv::Vec3b>(0, 0)[0], 125, 1);
  EXPECT_NEAR(image.at<cv::Vec3b>(119, 159)[0], 180, 1);
}

TEST(ColorSensor, ExposureVariesByTheConfiguredStops) {
  const ColorSensor sensor{.exposure_swing = 0.5, .exposure_period_s = 8.0};
  EXPECT_NEAR(exposure_gain(sensor, 0.0), 1.0, 1e-12);
  EXPECT_NEAR(exposure_gain(sensor, 2.0), std::sqrt(2.0), 1e-12);  // half a stop up after a quarter period
}

TEST(DepthSensor, NoiseGrowsWithTheSquareOfDistance) {
  DepthSensor sensor;
  sensor.noise_per_m = 0.002;
  sensor.disparity_step_px = 0.0;
  for (const float z : {1.0F, 2.0F, 4.0F}) {
    const std::vector<float> depth(kWidth * kHeight, z);
    const Statistics measured = statistics(simulate_depth({depth, kWidth, kHeight}, sensor, 3));
    const double sigma_mm = 1000.0 * 0.002 * static_cast<double>(z * z);
    EXPECT_NEAR(measured.mean, 1000.0 * static_cast<double>(z), 0.1 * sigma_mm);
    // Correlated over 6 px: about 2000 independent cells, 2 % standard error; 0.3 mm of rounding.
    EXPECT_NEAR(measured.deviation, sigma_mm, 0.07 * sigma_mm + 0.05);
  }
}

TEST(DepthSensor, NoiseFreeDepthIsQuantizedInDisparity) {
  DepthSensor sensor;
  sensor.noise_per_m = 0.0;
  const std::vector<float> depth(kWidth * kHeight, 3.0F);
  const cv::Mat image = simulate_depth({depth, kWidth, kHeight}, sensor, 3);
  // Disparity 30.5 / 3 = 10.1667 px rounds to 325 / 32 = 10.15625: 30.5 / 10.15625 = 3.00308 m.
  EXPECT_EQ(image.at<std::uint16_t>(100, 100), 3003);
}

TEST(DepthSensor, OutOfRangeIsNotMeasured) {
  const DepthSensor sensor;
  for (const float z : {0.2F, 9.0F, 0.0F}) {
    const std::vector<float> depth(kWidth * kHeight, z);
    EXPECT_EQ(cv::countNonZero(simulate_depth({depth, kWidth, kHeight}, sensor, 3)), 0) << z;
  }
}

TEST(DepthSensor, RegionOccludedInTheSecondImagerIsNotMeasured) {
  DepthSensor sensor;
  sensor.noise_per_m = 0.0;
  std::vector<float> depth(kWidth * kHeight, 4.0F);
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 160; column < 200; ++column)
      depth[static_cast<std::size_t>(row * kWidth + column)] = 1.0F;
  }
  const cv::Mat image = simulate_depth({depth, kWidth, kHeight}, sensor, 3);
  // Disparities 30.5 and 7.6 px: the object occludes 23 px to its left and none to its right.
  EXPECT_EQ(cv::countNonZero(image(cv::Rect(139, 0, 20, kHeight))), 0);
  EXPECT_EQ(cv::countNonZero(image(cv::Rect(100, 0, 30, kHeight))), 30 * kHeight);
  EXPECT_EQ(cv::countNonZero(image(cv::Rect(202, 0, 30, kHeight))), 30 * kHeight);
}

}  // namespace
}  // namespace stillpoint::synth
