// SPDX-License-Identifier: BSD-3-Clause
// Covariance of the motion that inertial data predicts, and of a state whose window began at an uncertain
// pose.
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

/// Each error of the origin moves the state rigidly, and gravity with it.
TEST(AddOrigin, IsTheErrorOfARigidMotion) {
  const NavState state = moving_state();
  const Pose T_w_o{exp_so3({-0.2, 0.4, 1.1}), {-2.0, 0.5, 1.0}};
  for (int i = 0; i < 6; ++i) {
    constexpr double kError = 1e-5;
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i % 3) * kError;
    const Pose moved_origin = i < 3 ? Pose{T_w_o.q, T_w_o.p + axis} : Pose{T_w_o.q * exp_so3(axis), T_w_o.p};
    const Pose motion = moved_origin * T_w_o.inverse();
    const Pose moved = motion * state.T_w_b;
    Eigen::Matrix<double, 9, 1> error;
    error << moved.p - state.T_w_b.p, log_so3(state.T_w_b.q.conjugate() * moved.q),
        motion.q * state.v_w - state.v_w;
    const Eigen::Vector2d of_gravity = gravity_difference(motion.q * kGravity, kGravity);

    UncertainPose origin{T_w_o};
    origin.covariance(i, i) = kError * kError;
    StateCovariance covariance{.inertial = true};
    covariance.gravity.setIdentity();
    add_origin(origin, state, kGravity, covariance);
    const Eigen::Matrix<double, 9, 9> added = covariance.state.topLeftCorner<9, 9>();
    EXPECT_LT((added - error * error.transpose()).norm(), 1e-2 * error.squaredNorm()) << i;
    const Eigen::Matrix2d tilt = covariance.gravity - Eigen::Matrix2d::Identity();
    EXPECT_LT((tilt - of_gravity * of_gravity.transpose()).norm(), 1e-2 * kError * kError) << i;
  }
}

TEST(AddOrigin, LeavesThePredictedMotionAsItIs) {
  const Preintegration imu = tenth_of_a_second({0.001, 0.01, 1e-5, 1e-4});
  StateCovariance claimed{.inertial = true};
  claimed.state.diagonal().setConstant(1e-6);
  const UncertainPose before = predicted_motion(moving_state(), claimed, imu, kGravity);
  const UncertainPose origin{{exp_so3({-0.2, 0.4, 1.1}), {-2.0, 0.5, 1.0}}, 0.01 * Matrix6::Identity()};
  add_origin(origin, moving_state(), kGravity, claimed);
  EXPECT_GT(claimed.position().trace(), 0.03);
  EXPECT_TRUE(
      predicted_motion(moving_state(), claimed, imu, kGravity).covariance.isApprox(before.covariance, 1e-9));
}

}  // namespace
}  // namespace stillpoint
