// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/motion/path_spline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/so3.h"
#include "datasets/synthetic/motion/camera_motion.h"

namespace stillpoint::synth {
namespace {

constexpr double kDegree = 0.017453292519943295;

PathSpline path_of(HandMotion motion, double to_s) {
  return hand_path(motion, {{0.0, -2.0, 1.5}, {0.0, 0.0, 1.0}}, {Pose{}, 3, 0.0, to_s});
}

ImuSensor ideal_sensor() {
  ImuSensor sensor;
  sensor.gyro_rate_hz = sensor.accel_rate_hz = 1000.0;
  sensor.noise = {.gyro_noise = 0.0, .accel_noise = 0.0, .gyro_walk = 0.0, .accel_walk = 0.0};
  sensor.gyro_bias = sensor.accel_bias = 0.0;
  return sensor;
}

TEST(ImuModel, IdealSamplesIntegrateToTheGroundTruth) {
  for (const HandMotion motion : {HandMotion::kXyz, HandMotion::kRpy, HandMotion::kHalfsphere}) {
    const PathSpline path = path_of(motion, 3.0);
    const ImuRecord record = simulate_imu(path, ideal_sensor(), {Timestamp{0}, 1.0, 2.1, 1});
    const double start_s = to_seconds(record.gyro.front().t);
    BodyMotion state = path.at(start_s);
    Pose pose = state.T_w_b;
    Eigen::Vector3d velocity = state.velocity_w;
    for (std::size_t i = 0; i + 1 < record.gyro.size() && i < 1000; ++i) {  // one second by the midpoint rule
      const double dt = seconds_between(record.gyro[i].t, record.gyro[i + 1].t);
      const Eigen::Quaterniond next =
          pose.q * exp_so3(0.5 * dt * (record.gyro[i].value + record.gyro[i + 1].value));
      // Gyroscope and accelerometer samples differ in phase by 0.045 of a sample: evaluate the force at the
      // gyroscope's times.
      const Eigen::Vector3d force = specific_force(path.at(start_s + (static_cast<double>(i) + 0.5) * dt));
      const Eigen::Vector3d acceleration =
          pose.q.slerp(0.5, next) * force - Eigen::Vector3d(0.0, 0.0, kGravity);
      pose.p += dt * velocity + 0.5 * dt * dt * acceleration;
      velocity += dt * acceleration;
      pose.q = next;
    }
    const Pose truth = path.pose_at(start_s + 1.0);
    EXPECT_LT((pose.p - truth.p).norm(), 1e-3);
    EXPECT_LT(log_so3(pose.q.conjugate() * truth.q).norm(), 0.01 * kDegree);
  }
}

TEST(ImuModel, AccelerometerSamplesMatchThePathAtTheirTimestamps) {
  const PathSpline path = path_of(HandMotion::kXyz, 2.0);
  const ImuRecord record = simulate_imu(path, ideal_sensor(), {Timestamp{5000000000}, 0.5, 1.5, 1});
  for (const datasets::VectorSample& sample : record.accel) {
    const double t_s = to_seconds(sample.t) - 5.0;
    EXPECT_LT((sample.value - specific_force(path.at(t_s))).norm(), 1e-6);
  }
}

TEST(ImuModel, WhiteNoiseHasTheConfiguredDensity) {
  ImuSensor noisy = ideal_sensor();
  noisy.noise.gyro_noise = 1e-3;
  const PathSpline path = path_of(HandMotion::kStatic, 12.0);
  const ImuRecord clean = simulate_imu(path, ideal_sensor(), {Timestamp{0}, 0.0, 10.0, 1});
  const ImuRecord record = simulate_imu(path, noisy, {Timestamp{0}, 0.0, 10.0, 1});
  double squares = 0.0;
  for (std::size_t i = 0; i < record.gyro.size(); ++i)
    squares += (record.gyro[i].value - clean.gyro[i].value).squaredNorm();
  const double sigma = std::sqrt(squares / (3.0 * static_cast<double>(record.gyro.size())));
  EXPECT_NEAR(sigma, 1e-3 * std::sqrt(1000.0), 0.03 * sigma);  // 30000 draws: 0.4 % standard error
}

TEST(ImuModel, BiasRandomWalkHasTheConfiguredDensity) {
  ImuSensor walking = ideal_sensor();
  walking.gyro_rate_hz = walking.accel_rate_hz = 10.0;
  walking.noise.accel_walk = 1e-2;
  const PathSpline path = path_of(HandMotion::kStatic, 402.0);
  double squares = 0.0;
  constexpr int kRuns = 100;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    const ImuRecord record = simulate_imu(path, walking, {Timestamp{0}, 0.0, 4.1, seed});
    const Eigen::Vector3d ideal = specific_force(path.at(to_seconds(record.accel[40].t)));
    squares += (record.accel[40].value - ideal).squaredNorm();
  }
  // After 40 steps of 0.1 s the bias has a standard deviation of 1e-2 * sqrt(4 s) = 0.02; 300 draws: 4 %
  // error.
  EXPECT_NEAR(std::sqrt(squares / (3.0 * kRuns)), 0.02, 0.003);
}

TEST(ImuModel, TimeOffsetShiftsOnlyTheTimestamps) {
  ImuSensor late = ideal_sensor();
  late.time_offset_s = 0.01;
  const PathSpline path = path_of(HandMotion::kXyz, 2.0);
  const ImuRecord record = simulate_imu(path, ideal_sensor(), {Timestamp{0}, 0.5, 1.0, 1});
  const ImuRecord shifted = simulate_imu(path, late, {Timestamp{0}, 0.5, 1.0, 1});
  EXPECT_EQ(shifted.gyro[9].t.ns - record.gyro[9].t.ns, 10000000);
  EXPECT_EQ(shifted.gyro[9].value, record.gyro[9].value);
}

}  // namespace
}  // namespace stillpoint::synth
