// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/inertial_interval.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace stillpoint {
namespace {

/// Samples at 200 Hz whose six values all vary, of 0.1 s from `begin_s` on.
std::vector<ImuSample> varying_samples(double begin_s) {
  std::vector<ImuSample> samples;
  for (int i = 0; i < 20; ++i) {
    const double t = begin_s + i / 200.0;
    const auto wave = [&](double rate) { return std::sin(rate * t + 0.1); };
    samples.push_back({.t = after({}, t),
                       .gyro_b = {wave(7.0), wave(11.0), wave(13.0)},
                       .accel_b = {5.0 * wave(5.0), 5.0 * wave(17.0), 9.0 + wave(3.0)}});
  }
  return samples;
}

TEST(SampleInspector, AcceptsSamplesThatVary) {
  SampleInspector inspector;
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(inspector.inspect(varying_samples(0.1 * i), false), StatusReason::kNone);
}

TEST(SampleInspector, FewerThanTwoSamplesAreAGap) {
  SampleInspector inspector;
  const std::vector<ImuSample> samples = varying_samples(0.0);
  EXPECT_EQ(inspector.inspect(std::vector<ImuSample>{}, false), StatusReason::kImuGap);
  EXPECT_EQ(inspector.inspect(std::span(samples).first(1), false), StatusReason::kImuGap);
  EXPECT_EQ(inspector.inspect(samples, true), StatusReason::kImuGap);
}

TEST(SampleInspector, FourSamplesAtTheLargestMagnitudeOfTheRunAreSaturated) {
  for (const int count : {3, 4}) {
    SampleInspector inspector;
    std::vector<ImuSample> samples = varying_samples(0.0);
    for (int i = 5; i < 5 + count; ++i) samples[static_cast<std::size_t>(i)].gyro_b.y() = -4.0;
    EXPECT_EQ(inspector.inspect(samples, false),
              count < 4 ? StatusReason::kNone : StatusReason::kImuSaturated);
  }
}

/// A limit below the largest magnitude of the run, e.g. of another axis.
TEST(SampleInspector, EightEqualSamplesWhileOthersVaryAreSaturated) {
  for (const int count : {7, 8}) {
    SampleInspector inspector;
    std::vector<ImuSample> samples = varying_samples(0.0);
    for (int i = 5; i < 5 + count; ++i) samples[static_cast<std::size_t>(i)].accel_b.x() = 2.0;
    EXPECT_EQ(inspector.inspect(samples, false),
              count < 8 ? StatusReason::kNone : StatusReason::kImuSaturated);
  }
}

TEST(SampleInspector, AnAxisWithoutSignalIsNotSaturated) {
  SampleInspector inspector;
  std::vector<ImuSample> samples = varying_samples(0.0);
  for (ImuSample& sample : samples) sample.gyro_b.x() = 0.0;
  EXPECT_EQ(inspector.inspect(samples, false), StatusReason::kNone);
}

TEST(InertialInterval, ConstantVelocitySamplesMeasureGravityAndTheBiases) {
  const NavState before{.gyro_bias = {0.01, 0.02, 0.03}, .accel_bias = {0.1, 0.2, 0.3}};
  const std::vector<ImuSample> samples =
      constant_velocity_samples(before, {0.0, 0.0, -9.81}, after({}, 1.0), after({}, 1.1));
  ASSERT_EQ(samples.size(), 2u);
  Preintegration imu(ImuNoise{}, before.gyro_bias, before.accel_bias);
  imu.integrate(samples);
  EXPECT_NEAR(imu.duration_s(), 0.1, 1e-12);
  EXPECT_LT(imu.predict(before, {0.0, 0.0, -9.81}).v_w.norm(), 1e-12);
}

TEST(InertialInterval, UnreliableNoiseLetsVisionDetermineTheMotion) {
  const ImuNoise sensor{.gyro_noise = 1e-3, .accel_noise = 1e-2, .gyro_walk = 1e-5, .accel_walk = 1e-4};
  const ImuNoise noise = unreliable_noise(sensor);
  EXPECT_GE(noise.gyro_noise * std::sqrt(0.033), 0.15);  // rad in a frame
  EXPECT_GE(noise.accel_noise * std::sqrt(0.033), 3.0);  // m/s
  EXPECT_EQ(noise.gyro_walk, sensor.gyro_walk);
  EXPECT_EQ(noise.accel_walk, sensor.accel_walk);
}

}  // namespace
}  // namespace stillpoint
