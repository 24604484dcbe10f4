// SPDX-License-Identifier: BSD-3-Clause
#include "core/imu/zero_velocity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/random.h"

namespace stillpoint {
namespace {

constexpr double kRate_hz = 200.0;
constexpr double kGravity = 9.81;
const ImuNoise kNoise{.gyro_noise = 2e-4, .accel_noise = 2e-3, .gyro_walk = 0.0, .accel_walk = 0.0};

NavState biased_state() {
  NavState state;
  state.gyro_bias = {0.01, -0.02, 0.03};
  state.accel_bias = {0.1, 0.2, -0.1};
  return state;
}

/// `count` samples of a tilted sensor at rest with white noise and the biases of `biased_state`.
std::vector<ImuSample> resting_samples(int count) {
  Random random(7);
  const double density = std::sqrt(kRate_hz);
  std::vector<ImuSample> samples;
  for (int i = 0; i < count; ++i) {
    ImuSample sample{.t = from_seconds(i / kRate_hz)};
    for (int k = 0; k < 3; ++k) {
      sample.gyro_b[k] = biased_state().gyro_bias[k] + kNoise.gyro_noise * density * random.normal();
      sample.accel_b[k] = biased_state().accel_bias[k] + kNoise.accel_noise * density * random.normal();
    }
    sample.accel_b += kGravity * Eigen::Vector3d(0.36, 0.48, 0.8);
    samples.push_back(sample);
  }
  return samples;
}

TEST(ZeroVelocityStatistic, IsAboutSixAtRest) {
  // Six components of unit variance, of which the mean direction absorbs a small part.
  EXPECT_NEAR(zero_velocity_statistic(resting_samples(2000), biased_state(), kNoise, kGravity), 6.0, 0.3);
}

TEST(ZeroVelocityStatistic, IsLargeForSlowRotationAndForSmallAcceleration) {
  std::vector<ImuSample> turning = resting_samples(40);
  for (ImuSample& sample : turning) sample.gyro_b.z() += 0.02;  // (0.02 / 0.0028)^2 = 50
  EXPECT_GT(zero_velocity_statistic(turning, biased_state(), kNoise, kGravity), 40.0);
  std::vector<ImuSample> shaking = resting_samples(40);
  for (std::size_t i = 0; i < shaking.size(); ++i)
    shaking[i].accel_b.x() += i % 2 == 0 ? 0.2 : -0.2;  // (0.2 / 0.028)^2 = 50
  EXPECT_GT(zero_velocity_statistic(shaking, biased_state(), kNoise, kGravity), 40.0);
}

TEST(ZeroVelocityStatistic, IsInfiniteWithoutSamplesOrDensities) {
  EXPECT_TRUE(std::isinf(zero_velocity_statistic(resting_samples(1), {}, kNoise, kGravity)));
  EXPECT_TRUE(std::isinf(zero_velocity_statistic(resting_samples(10), {}, ImuNoise{0, 0, 0, 0}, kGravity)));
}

}  // namespace
}  // namespace stillpoint
