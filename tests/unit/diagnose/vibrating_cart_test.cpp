// SPDX-License-Identifier: BSD-3-Clause
// Causes on a cart that drives straight: only its vibration tells, in images hardly, in the ground truth
// clearly.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "bench/diagnose/evidence/accelerometer_axes.h"
#include "bench/diagnose/inertial_causes.h"
#include "core/geometry/so3.h"

namespace stillpoint::bench {
namespace {

constexpr std::array<double, 3> kFrequency_radps{93.0, 39.0, 71.0};  // of the rotation and motion per axis

Eigen::Vector3d vibration(double t, double amplitude, int derivative) {
  Eigen::Vector3d value;
  for (int axis = 0; axis < 3; ++axis) {
    const double w = kFrequency_radps[static_cast<std::size_t>(axis)];
    value[axis] = amplitude / (w * w) * std::pow(w, derivative) * std::sin(w * t + 0.5 * M_PI * derivative);
  }
  return value;
}

struct CartOptions {
  double visual_noise_radps = 0.0;
  double drift = 0.0;  ///< of the clock of the IMU
};

/// 10 s at 1 m/s with a vibration of 2 m/s^2 and 0.05 rad/s; images show its rotation, and a straight motion.
struct VibratingCart {
  explicit VibratingCart(const CartOptions& options = {}) {
    constexpr double kRotation = 3.0;  // rad/s^2
    std::mt19937_64 random(3);         // NOLINT(cert-msc51-cpp,cert-msc32-c): the same noise in all runs
    std::normal_distribution<double> noise(0.0, std::max(1e-12, options.visual_noise_radps));
    info.rig.has_imu = true;
    for (int i = 0; i <= 2000; ++i) {
      const double t = 0.005 * i;
      const Eigen::Quaterniond q = exp_so3(vibration(t, kRotation, 0));
      const Eigen::Vector3d force = q.conjugate() * (vibration(t, 2.0, 2) + Eigen::Vector3d(0.0, 0.0, 9.81));
      info.imu.push_back({.t = from_seconds(10.0 + (1.0 + options.drift) * t),
                          .gyro_b = vibration(t, kRotation, 1),
                          .accel_b = force});
      if (i % 4 != 0) continue;
      info.ground_truth.trajectory.poses.push_back(
          {from_seconds(10.0 + t), Pose{q, vibration(t, 2.0, 0) + t * Eigen::Vector3d::UnitX()}});
    }
    for (int i = 1; i < 300; ++i) {
      const double from = (i - 1) / 30.0, to = i / 30.0;
      const Eigen::Quaterniond q_to = exp_so3(vibration(to, kRotation, 0));
      const Eigen::Quaterniond q = exp_so3(vibration(from, kRotation, 0)).conjugate() * q_to;
      const Eigen::Vector3d error(noise(random), noise(random), noise(random));
      survey.frames.push_back({.t = from_seconds(10.0 + to),
                               .T_now_last = Pose{q.conjugate() * exp_so3(error / 30.0),
                                                  q_to.conjugate() * Eigen::Vector3d::UnitX() / -30.0}});
      info.frame_times.push_back(survey.frames.back().t);
    }
  }

  [[nodiscard]] std::vector<std::string> causes() const {
    std::vector<std::string> ids;
    for (const Cause& cause : inertial_causes(info, survey)) ids.push_back(cause.id);
    return ids;
  }

  datasets::SequenceInfo info;
  RecordingSurvey survey;
};

using Ids = std::vector<std::string>;

TEST(VibratingCart, HasNoCauses) {
  EXPECT_EQ(VibratingCart().causes(), Ids{});
  EXPECT_EQ(VibratingCart({.visual_noise_radps = 0.02}).causes(), Ids{});
}

TEST(VibratingCart, TellsSwappedAxesOfTheAccelerometerByTheGroundTruth) {
  VibratingCart cart;
  const std::vector<ImuSample> right = cart.info.imu;
  for (ImuSample& sample : cart.info.imu) sample.accel_b = sample.accel_b({1, 0, 2}).eval();
  const std::vector<Cause> causes = inertial_causes(cart.info, cart.survey);
  ASSERT_EQ(causes.size(), 1u);
  EXPECT_EQ(causes[0].id, "accel_axes");
  causes[0].correction->change(cart.info);
  EXPECT_TRUE(cart.info.imu[500].accel_b.isApprox(right[500].accel_b));
}

/// Half a period of the vibration later, right axes look inverted.
TEST(VibratingCart, BlamesNoAxesForALateGroundTruth) {
  VibratingCart cart;
  for (StampedPose& pose : cart.info.ground_truth.trajectory.poses) pose.t = after(pose.t, 0.045);
  EXPECT_FALSE(accelerometer_axes(cart.info, cart.survey));
}

TEST(VibratingCart, BlamesNoAxesForATurnedGroundTruth) {
  VibratingCart cart;
  const Eigen::Quaterniond q(Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX()));
  for (StampedPose& pose : cart.info.ground_truth.trajectory.poses) pose.T_w_f.q = pose.T_w_f.q * q;
  EXPECT_EQ(cart.causes(), Ids{});
}

/// Was "axes of the gyroscope", as the motion between images does not tell those of the accelerometer.
TEST(VibratingCart, TellsThatBothSensorsAreTurned) {
  VibratingCart cart;
  for (ImuSample& sample : cart.info.imu) {
    for (Eigen::Vector3d* const value : {&sample.gyro_b, &sample.accel_b})
      *value = Eigen::Vector3d(value->x(), -value->z(), value->y());
  }
  const Ids causes = cart.causes();
  EXPECT_EQ(std::ranges::count(causes, "imu_axes"), 1);
  EXPECT_EQ(std::ranges::count(causes, "gyro_axes"), 0);
  EXPECT_EQ(std::ranges::count(causes, "accel_axes"), 0);
}

/// The rotation between images was too noisy for 6 degrees.
TEST(VibratingCart, TellsARotationOfTheCameraByTheGroundTruth) {
  VibratingCart cart({.visual_noise_radps = 0.02});
  cart.info.rig.T_b_c.q = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(cart.causes(), Ids{"extrinsics_rotation"});
}

/// On market it was taken for a rotation of the camera.
TEST(VibratingCart, TakesAVibrationOfTheImuAloneForNoRotation) {
  VibratingCart cart({.visual_noise_radps = 0.02});
  for (ImuSample& sample : cart.info.imu) sample.gyro_b.y() += 0.5 * sample.gyro_b.x();
  EXPECT_EQ(cart.causes(), Ids{});
}

/// No lag fits a clock that drifts by more than the vibration takes.
TEST(VibratingCart, TellsADriftingClock) {
  VibratingCart cart({.drift = 0.005});
  EXPECT_EQ(cart.causes(), Ids{"clock_drift"});
}

}  // namespace
}  // namespace stillpoint::bench
