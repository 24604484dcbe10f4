// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/state_prediction.h"

#include "core/backend/factors/gravity_direction.h"
#include "core/backend/vision/camera_pose.h"
#include "core/config/monitor_config.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"
#include "core/imu/propagation.h"

namespace stillpoint {
namespace {

Pose constant_velocity(const NavState& previous, const NavState& newest, Timestamp t) {
  const double fraction = seconds_between(newest.t, t) / seconds_between(previous.t, newest.t);
  const Pose step = product(previous.T_w_b.inverse(), newest.T_w_b);
  return product(newest.T_w_b, Pose{exp_so3(fraction * log_so3(step.q)), fraction * step.p});
}

}  // namespace

NavState extrapolate(const MotionState& motion, ImuBuffer& imu, Timestamp t) {
  NavState state = motion.newest;
  if (t == motion.newest.t) return state;
  if (motion.inertial) {
    NavState start = motion.newest;
    start.t = after(start.t, motion.time_offset_s);
    const std::vector<ImuSample>& samples = imu.samples_up_to(start.t, after(t, motion.time_offset_s));
    if (samples.size() >= 2) {
      state = propagate(start, samples, motion.gravity_w);
      state.t = t;
      return state;
    }
  }
  if (motion.previous.t < motion.newest.t) {
    state.T_w_b = constant_velocity(motion.previous, motion.newest, t);
  }
  state.t = t;
  return state;
}

UncertainPose predicted_motion(const NavState& state, const StateCovariance& claimed,
                               const Preintegration& imu, const Eigen::Vector3d& gravity_w) {
  using Index = ImuErrorIndex;
  const Eigen::Matrix3d R_b_w = state.T_w_b.R().transpose();
  // Of (dp, dtheta) by the error of the state, in the order of both.
  Eigen::Matrix<double, 6, 15> J = Eigen::Matrix<double, 6, 15>::Zero();
  J.block<3, 3>(Index::kPosition, Index::kRotation) = imu.duration_s() * skew(R_b_w * state.v_w);
  J.block<3, 3>(Index::kPosition, Index::kVelocity) = imu.duration_s() * R_b_w;
  J.rightCols<6>() = imu.jacobian().topRightCorner<6, 6>();
  return {.T_w_f = product(state.T_w_b.inverse(), imu.predict(state, gravity_w).T_w_b),
          .covariance = propagate(J, claimed.state) + imu.covariance().topLeftCorner<6, 6>()};
}

UncertainPose predicted_pose(const NavState& state, const StateCovariance& claimed, const Preintegration& imu,
                             const Eigen::Vector3d& gravity_w) {
  // In the body frame of the state, as the errors of the preintegration.
  Matrix15 Q = Matrix15::Identity();
  Q.block<3, 3>(ImuErrorIndex::kPosition, ImuErrorIndex::kPosition) = state.T_w_b.R();
  Q.block<3, 3>(ImuErrorIndex::kVelocity, ImuErrorIndex::kVelocity) = state.T_w_b.R();
  const Matrix15 J = propagate(Q, imu.jacobian());
  const Matrix15 covariance = propagate(J, claimed.state) + propagate(Q, imu.covariance());
  UncertainPose predicted{.T_w_f = imu.predict(state, gravity_w).T_w_b,
                          .covariance = covariance.topLeftCorner<6, 6>()};
  const Eigen::Matrix<double, 3, 2> by_gravity =
      0.5 * imu.duration_s() * imu.duration_s() * gravity_jacobian(gravity_w);
  predicted.covariance.topLeftCorner<3, 3>() += propagate(by_gravity, claimed.gravity);
  return predicted;
}

void add_origin(const UncertainPose& origin, const NavState& state, const Eigen::Vector3d& gravity_w,
                StateCovariance& covariance) {
  const Eigen::Matrix3d R_o = origin.T_w_f.R();
  Eigen::Matrix<double, 9, 6> J = Eigen::Matrix<double, 9, 6>::Zero();
  J.topLeftCorner<3, 3>().setIdentity();
  J.block<3, 3>(0, 3) = -skew(state.T_w_b.p - origin.T_w_f.p) * R_o;
  J.block<3, 3>(3, 3) = state.T_w_b.R().transpose() * R_o;
  if (covariance.inertial) J.block<3, 3>(6, 3) = -skew(state.v_w) * R_o;
  covariance.state.topLeftCorner<9, 9>() += propagate(J, origin.covariance);
  if (covariance.gravity.isZero(0.0)) return;
  const Eigen::Matrix<double, 2, 3> J_gravity = gravity_basis(gravity_w).transpose() * R_o;
  covariance.gravity += propagate<2, 3>(J_gravity, origin.covariance.bottomRightCorner<3, 3>());
}

void drop_old_samples(const MotionState& motion, ImuBuffer& imu) {
  if (motion.initialized)
    imu.drop_before(after(motion.newest.t, motion.time_offset_s - kMonitor.bias.history_s));
}

MotionPrior motion_prior(const MotionState& motion, ImuBuffer& imu, Timestamp from, Timestamp to) {
  if (!motion.initialized || !motion.uses_imu) return {};
  if (motion.inertial &&
      !imu.samples_up_to(after(from, motion.time_offset_s), after(to, motion.time_offset_s)).empty()) {
    return full_prior(extrapolate(motion, imu, from).T_w_b, extrapolate(motion, imu, to).T_w_b, motion.T_b_c);
  }
  return rotation_prior(imu.samples_up_to(after(from, motion.time_offset_s), after(to, motion.time_offset_s)),
                        motion.newest.gyro_bias, motion.T_b_c);
}

}  // namespace stillpoint
