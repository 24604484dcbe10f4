// SPDX-License-Identifier: BSD-3-Clause
// Covariance of the motion that inertial data predicts.
#include <gtest/gtest.h>

#include "core/backend/factors/gravity_direction.h"
#include "core/backend/state_prediction.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

const Eigen::Vector3d kGravity(0.0, 0.0, -9.81);

NavState moving_state() {
  NavState state;
  state.T_w_b = {exp_so3({0.3, -0.5, 0.8}), {1.0, 2.0, 3.0}};
  state.v_w = {0.8, -0.4, 0.2};
  return state;
}

Preintegration tenth_of_a_second(const ImuNoise& noise) {
  Preintegration imu(noise, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 20; ++i)
    samples.push_back({after(Timestamp{}, 0.005 * i), {0.1, 0.5, -0.2}, {0.3, 0.2, 9.9}});
  imu.integrate(samples);
  return imu;
}

/// Its motion relative to the state at the begin; that of gravity in the body frame is constant.
Pose motion_of(const NavState& state, const Preintegration& imu) {
  const Eigen::Vector3d gravity_w = state.T_w_b.q * (moving_state().T_w_b.q.conjugate() * kGravity);
  return state.T_w_b.inverse() * imu.predict(state, gravity_w).T_w_b;
}

TEST(PredictedMotion, HasTheCovarianceOfTheStateAndOfTheSamples) {
  const Preintegration imu = tenth_of_a_second({0.001, 0.01, 1e-5, 1e-4});
  const NavState state = moving_state();
  const UncertainPose exact = predicted_motion(state, {}, imu, kGravity);
  EXPECT_TRUE(exact.covariance.isApprox(imu.covariance().topLeftCorner<6, 6>()));
  for (int i = 3; i < 15; ++i) {  // the position at the begin does not matter
    constexpr double kError = 1e-5;
    NavState off = state;
    Eigen::Vector3d axis = Eigen::Vector3d::Unit(i % 3) * kError;
    if (i < 6) off.T_w_b.q = off.T_w_b.q * exp_so3(axis);
    if (i >= 6 && i < 9) off.v_w += axis;
    if (i >= 9 && i < 12) off.gyro_bias += axis;
    if (i >= 12) off.accel_bias += axis;
    const Pose moved = motion_of(off, imu);
    Eigen::Matrix<double, 6, 1> error;
    error << moved.p - exact.T_w_f.p, log_so3(exact.T_w_f.q.conjugate() * moved.q);
    StateCovariance claimed;
    claimed.state(i, i) = kError * kError;
    const Matrix6 by_state = predicted_motion(state, claimed, imu, kGravity).covariance - exact.covariance;
    EXPECT_TRUE(by_state.isApprox(error * error.transpose(), 1e-2)) << i;
  }
}

TEST(PredictedPose, HasTheCovarianceOfGravity) {
  const Preintegration imu = tenth_of_a_second({0.001, 0.01, 1e-5, 1e-4});
  const NavState state = moving_state();
  const UncertainPose exact = predicted_pose(state, {}, imu, kGravity);
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d d = 1e-4 * Eigen::Vector2d::Unit(i);
    const Eigen::Vector3d moved = imu.predict(state, rotate_gravity(kGravity, d)).T_w_b.p - exact.T_w_f.p;
    StateCovariance claimed;
    claimed.gravity(i, i) = 1e-8;
    const Matrix6 by_gravity = predicted_pose(state, claimed, imu, kGravity).covariance - exact.covariance;
    EXPECT_TRUE((by_gravity.topLeftCorner<3, 3>().isApprox(moved * moved.transpose(), 1e-2))) << i;
  }
}

}  // namespace
}  // namespace stillpoint
