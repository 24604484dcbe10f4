// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/inertial_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr double kInnovations_hz = 30.0;
constexpr double kInnovationSigma = 1e-3;  ///< of exact sensors
const ImuNoise kStatedNoise{.gyro_noise = 1e-3, .accel_noise = 1e-2, .gyro_walk = 1e-5, .accel_walk = 1e-4};

/// Frames whose innovations have `gyro` and `accel` times the standard deviation that the densities state;
/// the prediction claims what the estimated factors make of it.
void observe_innovations(InertialNoise& noise, double gyro, double accel, double seconds, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, kInnovationSigma);
  const auto sample = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  for (int i = 0; i < seconds * kInnovations_hz; ++i) {
    UncertainPose predicted;
    predicted.covariance.diagonal() << Eigen::Vector3d::Constant(
        std::pow(kInnovationSigma * noise.factors().accel, 2)),
        Eigen::Vector3d::Constant(std::pow(kInnovationSigma * noise.factors().gyro, 2));
    const UncertainPose visual{.T_w_f = {exp_so3(gyro * sample()), accel * sample()}};
    noise.observe(predicted, visual, 1.0 / kInnovations_hz);
  }
}

TEST(InertialNoise, StaysAtTheStatedDensitiesOfATrueDataSheet) {
  double sum = 0.0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    InertialNoise noise(kStatedNoise);
    observe_innovations(noise, 1.0, 1.0, 20.0, seed);
    EXPECT_GE(noise.factors().gyro, 1.0);
    EXPECT_LT(noise.factors().gyro, 1.6);
    sum += noise.factors().gyro;
  }
  EXPECT_LT(sum / 10.0, 1.3);
}

TEST(InertialNoise, FollowsEachSensorWithinSeconds) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    InertialNoise noise(kStatedNoise);
    observe_innovations(noise, 6.0, 3.0, 5.0, seed);
    EXPECT_NEAR(std::log(noise.factors().gyro / 6.0), 0.0, 0.5) << seed;
    EXPECT_NEAR(std::log(noise.factors().accel / 3.0), 0.0, 0.5) << seed;
    observe_innovations(noise, 1.0, 1.0, 8.0, seed);
    EXPECT_LT(noise.factors().gyro, 1.6) << seed;
  }
}

TEST(InertialNoise, IsAtMostThirtyTwoTimesTheStatedNoise) {
  InertialNoise noise(kStatedNoise);
  observe_innovations(noise, 1e3, 0.0, 20.0, 1);
  EXPECT_DOUBLE_EQ(noise.factors().gyro, 32.0);
  EXPECT_DOUBLE_EQ(noise.factors().accel, 1.0);
  EXPECT_DOUBLE_EQ(noise.densities().gyro_noise, 32.0 * kStatedNoise.gyro_noise);
  EXPECT_DOUBLE_EQ(noise.densities().gyro_walk, 32.0 * kStatedNoise.gyro_walk + 31.0 * 1e-4);
  EXPECT_DOUBLE_EQ(noise.densities().accel_walk, kStatedNoise.accel_walk);
  EXPECT_DOUBLE_EQ(noise.densities().accel_noise, kStatedNoise.accel_noise);
}

TEST(InertialNoise, HardlyMovesByASingleEvent) {
  InertialNoise noise(kStatedNoise);
  UncertainPose visual{.T_w_f = {exp_so3({1.0, 0.0, 0.0}), {100.0, 0.0, 0.0}}};
  visual.covariance.diagonal().setConstant(1e-6);
  noise.observe({}, visual, 1.0 / kInnovations_hz);
  EXPECT_LT(noise.factors().accel, 1.1);
  visual.T_w_f.p.x() = std::numeric_limits<double>::quiet_NaN();
  const double before = noise.factors().accel;
  noise.observe({}, visual, 1.0 / kInnovations_hz);
  EXPECT_DOUBLE_EQ(noise.factors().accel, before);
}

}  // namespace
}  // namespace stillpoint
