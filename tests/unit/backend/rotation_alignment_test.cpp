// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/rotation_alignment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/so3.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

constexpr double kDegree = M_PI / 180.0;

BackendConfig config() {
  BackendConfig config;
  config.extrinsics_sigma_rad = 2.0 * kDegree;
  config.time_offset_sigma_s = 0.02;
  return config;
}

/// Aligns the rotations of `seconds` of a motion with the samples of its IMU.
/// @param q_w_c of the camera at a time
template <class Rotation>
std::optional<RotationAlignment> aligned(const std::vector<ImuSample>& samples, const Rotation& q_w_c,
                                         const Rig& rig, double seconds) {
  ImuBuffer imu;
  for (const ImuSample& sample : samples) imu.add(sample);
  RotationAligner aligner(config(), rig);
  static_cast<void>(aligner.align(from_seconds(0.2), imu));
  const int count = static_cast<int>(std::lround(seconds * 10.0));
  for (int i = 0; i < count; ++i) {
    const double begin = 0.2 + 0.1 * i, end = begin + 0.1;
    aligner.add({from_seconds(begin), from_seconds(end), q_w_c(begin).conjugate() * q_w_c(end)});
  }
  return aligner.align(from_seconds(0.2 + 0.1 * count), imu);
}

TEST(RotationAligner, FindsRotationTimeOffsetAndBias) {
  SimulatedMotion motion{.noisy_imu = true};
  motion.imu_noise.gyro_noise = 2e-4;
  Rig rig = SimulatedMotion::rig();
  const Eigen::Quaterniond q_b_c = rig.T_b_c.q;
  rig.T_b_c.q = q_b_c * exp_so3(3.0 * kDegree * Eigen::Vector3d(1.0, -1.0, 1.0).normalized());
  // An image with the stamp t is taken at t + 40 ms of the IMU clock.
  const auto q_w_c = [&](double t) { return SimulatedMotion::state(t + 0.04).T_w_b.q * q_b_c; };
  const std::optional<RotationAlignment> found = aligned(motion.imu(5.0), q_w_c, rig, 3.0);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->time_offset_s, 0.04, 0.0005);
  EXPECT_LT(found->q_b_c.angularDistance(q_b_c), 0.2 * kDegree);
  EXPECT_LT((found->gyro_bias - motion.gyro_bias).norm(), 0.001);
  EXPECT_LT(std::sqrt(found->covariance(3, 3)), 0.004);
}

/// A cart that vibrates at 8.6 and 10.3 Hz: samples that are late by half of a period look mirrored, and
/// steps from the rig end in another minimum.
TEST(RotationAligner, FindsTheTimeOffsetOfAVibrationBeforeTheRotation) {
  const auto attitude = [](double t) {
    const double roll = 1.1e-3 * std::sin(2.0 * M_PI * 8.6 * t),
                 yaw = 1.3e-3 * std::sin(2.0 * M_PI * 10.3 * t);
    return exp_so3({roll, 0.0, yaw});
  };
  for (const double offset_s : {-0.05, 0.05}) {
    ImuBuffer imu;
    constexpr double kPeriod_s = 1.0 / 400.0;
    for (int i = 0; i <= 800; ++i) {
      const double t = i * kPeriod_s;
      const Eigen::Quaterniond dq = attitude(t - 0.5 * kPeriod_s).conjugate() * attitude(t + 0.5 * kPeriod_s);
      imu.add({.t = from_seconds(t + offset_s), .gyro_b = log_so3(dq) / kPeriod_s});
    }
    RotationAligner aligner(config(), {});
    std::optional<RotationAlignment> found;
    for (int i = 6; i < 36 && !found; ++i) {
      const double begin = i / 30.0, end = begin + 1.0 / 30.0;
      aligner.add({from_seconds(begin), from_seconds(end), attitude(begin).conjugate() * attitude(end)});
      found = aligner.align(from_seconds(end), imu);
    }
    ASSERT_TRUE(found) << offset_s;
    EXPECT_TRUE(found->is_of_offset_alone);
    EXPECT_NEAR(found->time_offset_s, offset_s, 0.0005);
    EXPECT_EQ(found->q_b_c.coeffs(), Eigen::Quaterniond::Identity().coeffs());
    EXPECT_GT(found->rig_contradiction, 100.0);
  }
}

/// A robot that turns about one axis does not show the rotation about it.
TEST(RotationAligner, KeepsTheAxisAboutWhichNothingTurns) {
  const auto angle = [](double t) { return 0.5 * std::sin(1.5 * t); };
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 1000; ++i) {
    const double t = i / 200.0;
    samples.push_back({.t = from_seconds(t), .gyro_b = {0.0, 0.0, 0.75 * std::cos(1.5 * t)}});
  }
  Rig rig;
  rig.T_b_c.q = exp_so3({0.0, 2.0 * kDegree, 2.0 * kDegree});
  const auto q_w_c = [&](double t) { return exp_so3({0.0, 0.0, angle(t)}); };
  const std::optional<RotationAlignment> found = aligned(samples, q_w_c, rig, 3.1);
  ASSERT_TRUE(found);
  const Eigen::Vector3d error = log_so3(found->q_b_c);
  EXPECT_LT(error.head<2>().norm(), 0.1 * kDegree);
  EXPECT_NEAR(error.z(), 2.0 * kDegree, 0.1 * kDegree);
  EXPECT_NEAR(std::sqrt(found->covariance(2, 2)), 2.0 * kDegree, 0.1 * kDegree);
}

TEST(RotationAligner, WaitsForTheFirstSeconds) {
  const SimulatedMotion motion;
  const Rig rig = SimulatedMotion::rig();
  const auto q_w_c = [&](double t) { return SimulatedMotion::state(t).T_w_b.q * rig.T_b_c.q; };
  EXPECT_FALSE(aligned(motion.imu(5.0), q_w_c, rig, 1.0));
  EXPECT_TRUE(aligned(motion.imu(5.0), q_w_c, rig, 3.1));
}

/// Without samples the configured values stay, as uncertain as before.
TEST(RotationAligner, StaysAtTheRigWithoutSamples) {
  const Rig rig = SimulatedMotion::rig();
  const auto q_w_c = [&](double t) { return SimulatedMotion::state(t).T_w_b.q; };
  const std::optional<RotationAlignment> found = aligned({}, q_w_c, rig, 3.1);
  ASSERT_TRUE(found);
  EXPECT_LT(found->q_b_c.angularDistance(rig.T_b_c.q), 1e-9);
  EXPECT_NEAR(std::sqrt(found->covariance(3, 3)), 0.02, 1e-9);
}

}  // namespace
}  // namespace stillpoint
