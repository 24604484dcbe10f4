// SPDX-License-Identifier: BSD-3-Clause
// White noise and bias of inertial sensors at rest.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/calibration/resting_noise.h"

namespace stillpoint {
namespace {

constexpr double kRestGyroNoise = 1.7e-4, kRestAccelNoise = 2e-3, kRestRate_hz = 200.0;
const Eigen::Vector3d kRestGyroBias(-0.002, 0.02, 0.077);

/// Sensors at rest with white noise.
std::vector<ImuSample> resting_samples(double seconds) {
  std::mt19937_64 random(5);  // NOLINT(cert-msc51-cpp,cert-msc32-c): the same noise in all runs
  std::normal_distribution<double> normal(0.0, std::sqrt(kRestRate_hz));
  const auto noise = [&](double density) -> Eigen::Vector3d {
    return density * Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  std::vector<ImuSample> samples;
  for (int i = 0; i < static_cast<int>(kRestRate_hz * seconds); ++i)
    samples.push_back({from_seconds(10.0 + i / kRestRate_hz), kRestGyroBias + noise(kRestGyroNoise),
                       Eigen::Vector3d(0.0, 0.0, 9.81) + noise(kRestAccelNoise)});
  return samples;
}

/// Adds a rotation rate and an acceleration of a frequency.
void shake(std::vector<ImuSample>& samples, double frequency_hz, double rate_radps) {
  for (ImuSample& sample : samples) {
    const double wave = std::sin(2.0 * M_PI * frequency_hz * seconds_between(samples.front().t, sample.t));
    sample.gyro_b.x() += rate_radps * wave;
    sample.accel_b.y() += 10.0 * rate_radps * wave;
  }
}

TEST(RestingNoise, IsThatOfTheSensors) {
  const auto noise = resting_noise(resting_samples(20.0));
  ASSERT_TRUE(noise);
  EXPECT_NEAR(noise->seconds, 20.0, 1.5);
  EXPECT_LT(noise->relative_sigma, 0.03);  // of 1140 differences
  EXPECT_NEAR(noise->gyro_noise / kRestGyroNoise, 1.0, 3.0 * noise->relative_sigma);
  EXPECT_NEAR(noise->accel_noise / kRestAccelNoise, 1.0, 3.0 * noise->relative_sigma);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(noise->gyro_bias[axis], kRestGyroBias[axis], 3.5 * noise->gyro_bias_sigma);
}

TEST(RestingNoise, IsAbsentInMotionAndVibration) {
  for (const double frequency_hz : {0.5, 3.0, 40.0}) {
    auto samples = resting_samples(20.0);
    shake(samples, frequency_hz, 0.05);
    EXPECT_FALSE(resting_noise(samples)) << frequency_hz;
  }
  EXPECT_FALSE(resting_noise(resting_samples(0.9)));
  EXPECT_FALSE(resting_noise({}));
}

TEST(RestingNoise, IsThatOfTheSecondsAtRest) {
  auto samples = resting_samples(20.0);
  std::vector<ImuSample> moving(samples.begin() + 1000, samples.end());
  shake(moving, 1.0, 0.3);
  std::ranges::copy(moving, samples.begin() + 1000);
  const auto noise = resting_noise(samples);
  ASSERT_TRUE(noise);
  EXPECT_NEAR(noise->seconds, 5.0, 1.5);
  EXPECT_NEAR(noise->gyro_noise / kRestGyroNoise, 1.0, 3.0 * noise->relative_sigma);
}

TEST(RestingNoise, HasNoWindowAcrossAGap) {
  auto samples = resting_samples(1.9);
  for (std::size_t i = 190; i < samples.size(); ++i) samples[i].t = after(samples[i].t, 0.5);
  EXPECT_FALSE(resting_noise(samples));
}

}  // namespace
}  // namespace stillpoint
