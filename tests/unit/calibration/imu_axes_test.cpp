// SPDX-License-Identifier: BSD-3-Clause
// Calibration of scale and misalignment of gyroscope and accelerometer, on simulated recordings.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

#include "core/calibration/calibrate.h"
#include "core/calibration/imu_axes_factor.h"
#include "core/geometry/so3.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

constexpr double kAxesSeconds = 10.0;
constexpr double kSampleRate_hz = 200.0;

/// A hand that turns by half a radian about all axes, or a robot on a plane.
Pose pose_at(double t, bool planar) {
  const Eigen::Vector3d position(0.4 * std::sin(2.1 * t), 0.4 * std::sin(2.7 * t + 0.5),
                                 0.3 * std::sin(3.3 * t + 1.0));
  const Eigen::Vector3d angles(0.5 * std::sin(2.9 * t), 0.5 * std::sin(2.3 * t + 0.7),
                               0.5 * std::sin(1.9 * t));
  if (!planar) return {exp_so3(angles), position};
  return {exp_so3({0.0, 0.0, angles.z()}), {position.x(), position.y(), 0.0}};
}

/// Samples of sensors with these axes, with noise and constant biases.
std::vector<ImuSample> axes_samples(const ImuAxes& axes, bool planar, std::uint32_t seed) {
  constexpr double h = 1e-4;
  const ImuNoise noise;
  Random random(100 + seed);
  std::vector<ImuSample> samples;
  for (int i = 0; i <= static_cast<int>((kAxesSeconds + 1.0) * kSampleRate_hz); ++i) {
    const double t = i / kSampleRate_hz;
    const Pose before = pose_at(t - h, planar), now = pose_at(t, planar), later = pose_at(t + h, planar);
    const Eigen::Vector3d rate = log_so3(before.q.conjugate() * later.q) / (2.0 * h);
    const Eigen::Vector3d acceleration = (later.p - 2.0 * now.p + before.p) / (h * h);
    const Eigen::Vector3d force = now.q.conjugate() * (acceleration + Eigen::Vector3d(0.0, 0.0, 9.81));
    const Eigen::Vector3d gyro_noise = noise.gyro_noise * std::sqrt(kSampleRate_hz) * random.normal3();
    const Eigen::Vector3d accel_noise = noise.accel_noise * std::sqrt(kSampleRate_hz) * random.normal3();
    samples.push_back({from_seconds(t), axes.gyro * rate + gyro_noise + Eigen::Vector3d::Constant(0.01),
                       axes.accel * force + accel_noise + Eigen::Vector3d::Constant(0.05)});
  }
  return samples;
}

/// Keyframes that see points all around.
CalibrationInput axes_recording(const ImuAxes& axes, bool planar, std::uint32_t seed) {
  const Rig rig = SimulatedMotion::rig();
  Random places(5), random(seed);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 150; ++i) points.push_back(places.uniform3({2.0, -5.0, -4.0}, {6.0, 5.0, 4.0}));
  CalibrationInput input{.stated = {.rig = rig, .depth_camera = rig.camera},
                         .imu = axes_samples(axes, planar, seed)};
  CalibrationSection& section = input.sections.emplace_back();
  section.gravity_w = -Eigen::Vector3d::UnitZ();
  for (double t = 0.2; t < kAxesSeconds; t += 0.15) {
    CalibrationKeyframe keyframe{.T_w_c = pose_at(t, planar) * rig.T_b_c};
    keyframe.state.t = from_seconds(t);
    keyframe.state.v_w = (pose_at(t + 1e-4, planar).p - pose_at(t - 1e-4, planar).p) / 2e-4;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p_c = keyframe.T_w_c.inverse() * points[i];
      if (p_c.z() < 0.5 || !rig.camera.contains(rig.camera.project(p_c))) continue;
      const Eigen::Vector2d noise = 0.3 * random.normal2();
      keyframe.features.push_back({.track = static_cast<std::int64_t>(i),
                                   .pixel = rig.camera.project(p_c) + noise,
                                   .depth_m = 1.0 / (1.0 / p_c.z() + 0.003 * random.normal())});
    }
    section.keyframes.push_back(std::move(keyframe));
  }
  return input;
}

/// Scales of 0.5 % and angles of 0.3 degrees, with random signs.
ImuAxesValues wrong_values(std::uint32_t seed) {
  Random random(900 + seed);
  ImuAxesValues values{};
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = (random.normal() < 0.0 ? -1.0 : 1.0) * (i % 6 < 3 ? 0.005 : 0.3 * M_PI / 180.0);
  return values;
}

bool is_axis(const ParameterEstimate& p) {
  return p.name.starts_with("gyro ") || p.name.starts_with("accel ");
}

/// The estimates of the axes, in the order of ImuAxesValues.
std::vector<ParameterEstimate> axes_of_result(const CalibrationResult& result) {
  std::vector<ParameterEstimate> axes;
  std::ranges::copy_if(result.parameters, std::back_inserter(axes), is_axis);
  return axes;
}

/// In the unit of the parameters.
double true_axis(const ImuAxesValues& values, std::size_t index) {
  return values[index] * (index % 6 < 3 ? 100.0 : 180.0 / M_PI);
}

TEST(ImuAxes, AreFoundWithinTheirClaimedDeviations) {
  double squares = 0.0;
  int count = 0, outside = 0;
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const ImuAxesValues values = wrong_values(seed);
    const CalibrationResult result =
        calibrate(axes_recording(axes_of(values), false, seed), {.hold_out = false});
    ASSERT_TRUE(result.usable);
    const std::vector<ParameterEstimate> axes = axes_of_result(result);
    ASSERT_EQ(axes.size(), values.size());
    for (std::size_t i = 0; i < axes.size(); ++i) {
      EXPECT_NE(axes[i].outcome, ParameterOutcome::kNotObserved) << axes[i].name;
      const double error = (axes[i].value - true_axis(values, i)) / axes[i].sigma;
      squares += error * error;
      ++count;
      outside += std::abs(error) > 3.0;
      if (seed == 0 || std::abs(error) > 3.0)
        std::printf("seed %u %s: %.4f +- %.4f, true %.4f\n", seed, axes[i].name.c_str(), axes[i].value,
                    axes[i].sigma, true_axis(values, i));
    }
    const ImuAxes found = result.calibration.rig.imu_axes, truth = axes_of(values);
    EXPECT_LT((found.gyro - truth.gyro).cwiseAbs().maxCoeff(), 0.003);
    EXPECT_LT((found.accel - truth.accel).cwiseAbs().maxCoeff(), 0.01);
  }
  std::printf("%d values, %d beyond 3 sigma, mean normalized squared error %.3f\n", count, outside,
              squares / count);
  EXPECT_EQ(outside, 0);
  EXPECT_GT(squares / count, 0.5);
  EXPECT_LT(squares / count, 1.4);
}

TEST(ImuAxes, LeaveTheOtherParametersWithinTheirDeviations) {
  for (std::uint32_t seed = 0; seed < 2; ++seed) {
    const CalibrationInput input = axes_recording(axes_of(wrong_values(seed)), false, seed);
    const CalibrationResult result = calibrate(input, {.hold_out = false});
    for (const ParameterEstimate& p : result.parameters) {
      if (is_axis(p) || p.outcome == ParameterOutcome::kNotObserved) continue;
      EXPECT_LT(std::abs(p.difference()), 3.0 * p.sigma) << p.name;
    }
  }
}

TEST(ImuAxes, OfExactSensorsAgree) {
  const CalibrationResult result = calibrate(axes_recording({}, false, 3), {.hold_out = false});
  for (const ParameterEstimate& p : axes_of_result(result))
    EXPECT_EQ(p.outcome, ParameterOutcome::kAgrees) << p.name << " " << p.value << " +- " << p.sigma;
}

TEST(ImuAxes, ThatMotionOnAPlaneDoesNotShowStayAsStated) {
  CalibrationInput input = axes_recording(axes_of(wrong_values(1)), true, 1);
  const CalibrationResult result = calibrate(input, {.hold_out = false});
  const std::vector<ParameterEstimate> axes = axes_of_result(result);
  ASSERT_EQ(axes.size(), std::size_t{kImuAxesCount});
  for (const std::size_t i : {0u, 1u, 3u, 8u}) {  // gyro scale x, y, axes xy; accel scale z
    EXPECT_EQ(axes[i].outcome, ParameterOutcome::kNotObserved) << axes[i].name;
    EXPECT_EQ(axes[i].value, 0.0) << axes[i].name;
  }
  const ParameterEstimate& turning = axes[2];  // gyro scale z
  EXPECT_NE(turning.outcome, ParameterOutcome::kNotObserved);
  EXPECT_LT(std::abs(turning.value - true_axis(wrong_values(1), 2)), 3.0 * turning.sigma);
}

TEST(ImuAxes, AreRelativeToTheStatedOnesAndKeptIfWanted) {
  const ImuAxes stated = axes_of(wrong_values(4));
  CalibrationInput input = axes_recording({}, false, 4);
  input.stated.rig.imu_axes = stated;  // the samples are corrected by them
  const CalibrationResult kept = calibrate(input, {.estimate = {.imu_intrinsics = false}, .hold_out = false});
  EXPECT_EQ(kept.calibration.rig.imu_axes, stated);
  EXPECT_TRUE(axes_of_result(kept).empty());
  const CalibrationResult result = calibrate(input, {.hold_out = false});
  EXPECT_LT((result.calibration.rig.imu_axes.gyro - stated.gyro).cwiseAbs().maxCoeff(), 0.003);
  for (const ParameterEstimate& p : axes_of_result(result)) EXPECT_EQ(p.stated, 0.0);
}

TEST(ImuAxes, DerivativesAreThoseOfOtherSamples) {
  const ImuAxesValues values = wrong_values(7);
  std::vector<ImuSample> raw = axes_samples({}, false, 7);
  raw.resize(40);
  const auto integrated = [&](const ImuAxesValues& at) {
    std::vector<ImuSample> samples;
    for (const ImuSample& sample : raw) samples.push_back(axes_of(at).corrected(sample));
    Preintegration imu(ImuNoise{}, Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.05));
    imu.integrate(samples);
    return imu;
  };
  const Preintegration imu = integrated(values);
  const ImuAxesJacobian J = imu_axes_jacobian(imu, ImuNoise{}, values);
  for (int k = 0; k < kImuAxesCount; ++k) {
    ImuAxesValues changed = values;
    changed[static_cast<std::size_t>(k)] += 1e-3;
    const Preintegration other = integrated(changed);
    const Eigen::Vector3d bg = imu.gyro_bias(), ba = imu.accel_bias();
    const Eigen::Vector3d turned = log_so3(imu.delta_q(bg).conjugate() * other.delta_q(bg));
    EXPECT_LT((J.col(k).segment<3>(0) * 1e-3 - (other.delta_p(bg, ba) - imu.delta_p(bg, ba))).norm(), 1e-6);
    EXPECT_LT((J.col(k).segment<3>(3) * 1e-3 - turned).norm(), 1e-6);
    EXPECT_LT((J.col(k).segment<3>(6) * 1e-3 - (other.delta_v(bg, ba) - imu.delta_v(bg, ba))).norm(), 1e-5);
  }
}

}  // namespace
}  // namespace stillpoint
