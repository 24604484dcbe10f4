// SPDX-License-Identifier: BSD-3-Clause
/// Navigation state of the body: pose, velocity and IMU biases, their covariance, and the camera motion
/// predicted from inertial data.
#pragma once

#include <Eigen/Core>

#include "core/base/timestamp.h"
#include "core/geometry/pose.h"

namespace stillpoint {

struct NavState {
  Timestamp t;
  Pose T_w_b;
  Eigen::Vector3d v_w = Eigen::Vector3d::Zero();         ///< [m/s]
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// Covariances of the newest state, in the tangent space of the estimate, in SI units and radians:
///
///   T_w_b = (p + dp, q Exp(dtheta)),   v_w + dv,   bg + dbg,   ba + dba
///
/// dp and dv in the world frame, dtheta and the biases in the body frame. They are relative to the first pose
/// of the segment, which is exact.
struct StateCovariance {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Matrix15 = Eigen::Matrix<double, 15, 15>;

  /// Of (dp, dtheta, dv, dbg, dba); zero beyond the first six rows and columns unless `inertial`.
  Matrix15 state = Matrix15::Zero();
  /// Of the rotation that Exp(B(g) d) applies to gravity, see core/backend/factors/gravity_direction.h; zero
  /// if gravity is constant.
  Eigen::Matrix2d gravity = Eigen::Matrix2d::Zero();
  /// Of T_b_c, in the same tangent space as the pose; zero if constant.
  Matrix6 extrinsics = Matrix6::Zero();
  double time_offset = 0.0;                        ///< variance [s^2]; zero if constant
  double depth_scale = 0.0;                        ///< variance of its inverse; zero if constant
  Eigen::Matrix4d lens = Eigen::Matrix4d::Zero();  ///< of the lens correction; zero if constant
  bool inertial = false;                           ///< velocity and biases are estimated

  [[nodiscard]] Matrix6 pose() const { return state.topLeftCorner<6, 6>(); }
  [[nodiscard]] Eigen::Matrix3d position() const { return state.block<3, 3>(0, 0); }
  [[nodiscard]] Eigen::Matrix3d rotation() const { return state.block<3, 3>(3, 3); }
  [[nodiscard]] Eigen::Matrix3d velocity() const { return state.block<3, 3>(6, 6); }
  [[nodiscard]] Eigen::Matrix3d gyro_bias() const { return state.block<3, 3>(9, 9); }
  [[nodiscard]] Eigen::Matrix3d accel_bias() const { return state.block<3, 3>(12, 12); }
};

/// Predicted relative motion from the previous camera frame to the current one.
struct MotionPrior {
  Pose T_ccur_cprev;
  bool has_rotation = false;     ///< gyroscope samples cover the interval
  bool has_translation = false;  ///< velocity and gravity are known as well
};

}  // namespace stillpoint
