// SPDX-License-Identifier: BSD-3-Clause
#include "core/imu/propagation.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "tests/unit/imu/motions.h"

namespace stillpoint {
namespace {

/// Camera looking along the body's x axis, 10 cm ahead and 5 cm up.
Pose forward_camera() {
  Eigen::Matrix3d R_b_c;
  R_b_c << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return {Eigen::Quaterniond(R_b_c), {0.1, 0.0, 0.05}};
}

TEST(Propagate, FollowsACircularMotion) {
  const Circle circle;
  const std::vector<ImuSample> samples = sample_motion(1.0, 200.0, [&](double) { return circle.imu(); });
  ASSERT_EQ(samples.size(), 201u);
  // Midpoint rule with a = 4.5 m/s^2, w = 1.5 rad/s: the velocity error is a (w dt)^2 / 12 t, the position
  // error its integral plus a w dt^3 / 12 per step: 1.1e-5 + 1.4e-5 m after one second.
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const NavState state = propagate(circle.state(0.0), std::span(samples).first(i + 1), kGravity);
    const NavState truth = circle.state(to_seconds(samples[i].t));
    EXPECT_EQ(state.t, samples[i].t);
    EXPECT_LT((state.T_w_b.p - truth.T_w_b.p).norm(), 2.5e-5);
    EXPECT_LT(state.T_w_b.q.angularDistance(truth.T_w_b.q), 1e-7);
  }
}

TEST(Propagate, MatchesThePreintegration) {
  const std::vector<ImuSample> samples = rich_motion_samples(0.5);
  NavState start = Circle{}.state(0.0);
  start.gyro_bias = {0.01, 0.02, -0.03};
  start.accel_bias = {0.1, -0.1, 0.2};
  Preintegration imu(ImuNoise{}, start.gyro_bias, start.accel_bias);
  imu.integrate(samples);
  const NavState expected = imu.predict(start, kGravity);
  const NavState end = propagate(start, samples, kGravity);
  EXPECT_LT((end.T_w_b.p - expected.T_w_b.p).norm(), 1e-12);
  EXPECT_LT((end.v_w - expected.v_w).norm(), 1e-12);
  EXPECT_LT(log_so3(end.T_w_b.q.conjugate() * expected.T_w_b.q).norm(), 1e-12);
}

TEST(Propagate, ReturnsTheStartStateForASingleSample) {
  const NavState start = Circle{}.state(0.0);
  EXPECT_EQ(propagate(start, std::vector<ImuSample>(1), kGravity).T_w_b.p, start.T_w_b.p);
}

TEST(RotationPrior, RotatesPointsAgainstTheBodyRotation) {
  // The body yaws left by 0.2 rad: points in a forward camera move right, a rotation by +0.2 about the y axis
  // of the camera (which points down).
  const Eigen::Vector3d bias(0.01, 0.02, 0.03);
  const std::vector<ImuSample> samples = sample_motion(
      0.1, 200.0, [&](double) { return ImuSample{.t = {}, .gyro_b = Eigen::Vector3d(0, 0, 2.0) + bias}; });
  const MotionPrior prior = rotation_prior(samples, bias, forward_camera());
  EXPECT_TRUE(prior.has_rotation);
  EXPECT_FALSE(prior.has_translation);
  EXPECT_LT((log_so3(prior.T_ccur_cprev.q) - Eigen::Vector3d(0.0, 0.2, 0.0)).norm(), 1e-12);
  EXPECT_GT((prior.T_ccur_cprev.q * Eigen::Vector3d(0.0, 0.0, 5.0)).x(), 0.9);  // 5 sin 0.2
}

TEST(RotationPrior, IsInvalidWithFewerThanTwoSamples) {
  EXPECT_FALSE(rotation_prior(std::vector<ImuSample>(1), Eigen::Vector3d::Zero(), Pose{}).has_rotation);
}

TEST(FullPrior, AgreesWithTheRotationPriorAndTransformsPoints) {
  const Circle circle;
  const NavState before = circle.state(0.0);
  const NavState now = circle.state(0.1);
  const Pose T_b_c = forward_camera();
  const MotionPrior full = full_prior(before.T_w_b, now.T_w_b, T_b_c);
  const std::vector<ImuSample> samples = sample_motion(0.1, 200.0, [&](double) { return circle.imu(); });
  const MotionPrior rotation = rotation_prior(samples, Eigen::Vector3d::Zero(), T_b_c);
  EXPECT_TRUE(full.has_translation);
  EXPECT_LT(log_so3(full.T_ccur_cprev.q.conjugate() * rotation.T_ccur_cprev.q).norm(), 1e-12);
  // A static world point must be transformed from the previous to the current camera.
  const Eigen::Vector3d p_w(5.0, 1.0, 0.5);
  const Eigen::Vector3d p_cprev = (before.T_w_b * T_b_c).inverse() * p_w;
  const Eigen::Vector3d p_ccur = (now.T_w_b * T_b_c).inverse() * p_w;
  EXPECT_LT((full.T_ccur_cprev * p_cprev - p_ccur).norm(), 1e-12);
}

}  // namespace
}  // namespace stillpoint
