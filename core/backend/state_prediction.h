// SPDX-License-Identifier: BSD-3-Clause
/// Prediction of states and camera motion outside the window. Paper Sec. III-A ("IMU preintegration").
#pragma once

#include "core/geometry/covariance.h"
#include "core/imu/imu_buffer.h"
#include "core/imu/preintegration.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// Motion estimate after a frame, as needed for predictions: the feedback to the tracker.
struct MotionState {
  NavState newest;    ///< last reported state
  NavState previous;  ///< the state before it: constant velocity model without an IMU
  Pose T_b_c;
  Eigen::Vector3d gravity_w = Eigen::Vector3d::Zero();
  double time_offset_s = 0.0;
  bool initialized = false;  ///< the window holds at least one frame
  bool uses_imu = false;     ///< biases and time offset are valid
  bool inertial = false;     ///< gravity and velocity are initialized
};

/// State at an image timestamp >= `newest.t`: IMU propagation, or constant velocity without samples.
[[nodiscard]] NavState extrapolate(const MotionState& motion, ImuBuffer& imu, Timestamp t);

/// Motion T_bi_bj of the body from the frame of a state i to the next one, with its covariance. With the
/// duration T, the velocity v_b = R_i^T v_i in the body frame and the Jacobians J of the preintegration,
///
///   dp = T dv_b + J_pbg dbg + J_pba dba + noise,    dtheta = J_qbg dbg + noise,
///   dv_b = R_i^T dv + [v_b]x dtheta_i.
///
/// The error of the direction of gravity is left out: 0.1 mm per degree at 30 Hz.
/// @param claimed of `state`, inertial
/// @param imu     from `state` on
[[nodiscard]] UncertainPose predicted_motion(const NavState& state, const StateCovariance& claimed,
                                             const Preintegration& imu, const Eigen::Vector3d& gravity_w);

/// Pose after inertial data alone, with the covariance of the state propagated as in Preintegration, and that
/// of the direction of gravity P_g added: with the basis B(g) of gravity_direction.h, after the time T,
///
///   dp = J_g d,    J_g = -1/2 T^2 [g]x B(g),    P <- P + J_g P_g J_g^T.
///
/// The correlation of gravity with attitude and accelerometer bias is no part of StateCovariance and left
/// out.
/// @param claimed of `state`, inertial
/// @param imu     from `state` on
[[nodiscard]] UncertainPose predicted_pose(const NavState& state, const StateCovariance& claimed,
                                           const Preintegration& imu, const Eigen::Vector3d& gravity_w);

/// Adds the error of the pose o at which the window of a state began, as the window takes it for exact:
///
///   dp = dp_o - [p - p_o]x R_o dtheta_o,    dtheta = R^T R_o dtheta_o,    dv = -[v]x R_o dtheta_o,
///
/// and, if gravity is estimated, d = B(g)^T R_o dtheta_o of its direction, see gravity_direction.h.
/// @param covariance of `state`, given o
void add_origin(const UncertainPose& origin, const NavState& state, const Eigen::Vector3d& gravity_w,
                StateCovariance& covariance);

/// Drops IMU samples older than the newest state.
void drop_old_samples(const MotionState& motion, ImuBuffer& imu);

/// Predicted camera motion between two frames, for the tracker; requires `newest.t` <= `from`. Uses inertial
/// data only: a constant-velocity prediction biases weakly textured features towards the prediction, and this
/// error feeds back into the estimate.
[[nodiscard]] MotionPrior motion_prior(const MotionState& motion, ImuBuffer& imu, Timestamp from,
                                       Timestamp to);

}  // namespace stillpoint
