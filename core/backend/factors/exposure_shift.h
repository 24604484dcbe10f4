// SPDX-License-Identifier: BSD-3-Clause
/// Moves a state from the exposure of its frame to the end of a preintegration, by the time offset between.
#pragma once

#include <Eigen/Core>

namespace stillpoint {

/// One end of a preintegration, at IMU time `state.t + time_offset_s`, and what the IMU measures there.
struct ImuEnd {
  double time_offset_s = 0.0;  ///< estimated offset when the preintegration was computed
  Eigen::Vector3d gyro_b = Eigen::Vector3d::Zero();   ///< bias included [rad/s]
  Eigen::Vector3d accel_b = Eigen::Vector3d::Zero();  ///< specific force, bias included [m/s^2]
};

/// Parameter blocks of a state.
struct StateBlocks {
  const double* pose;        ///< p, q xyzw
  const double* speed_bias;  ///< v, gyro bias, accel bias
};

/// A state x = (p, q, v, b_g, b_a) is defined at the exposure of its frame, that is, at IMU time t + td. A
/// preintegration ends at t + td_k, with td_k the estimate of td when it was computed. With d = td - td_k,
/// w = gyro - b_g, f = accel - b_a and gravity g, the state at that end is
///
///   p' = p - d v + 1/2 d^2 a,    q' = q Exp(-d w),    v' = v - d a,    a = R(q) f + g
///
/// up to the change of w and a within d. The derivatives of a residual r by x, td and g follow from those by
/// x' (theta: right tangent of q):
///
///   r_p     = r_p'
///   r_theta = r_theta' Exp(d w) + (d r_v' - 1/2 d^2 r_p') R [f]x
///   r_v     = r_v' - d r_p'
///   r_bg    = r_bg' + d r_theta' J_r(-d w)
///   r_ba    = r_ba' + (d r_v' - 1/2 d^2 r_p') R
///   r_td    = -r_p' v' - r_theta' w - r_v' a
///   r_g     = 1/2 d^2 r_p' - d r_v'
///
/// Li and Mourikis 2014, Sec. 3, estimate the offset between the clocks in the same way, as a state of the
/// inertial equations.
class ExposureShift {
 public:
  using PoseJacobian = Eigen::Map<Eigen::Matrix<double, 15, 7, Eigen::RowMajor>>;
  using SpeedBiasJacobian = Eigen::Map<Eigen::Matrix<double, 15, 9, Eigen::RowMajor>>;
  using Vector15 = Eigen::Matrix<double, 15, 1>;

  /// @param state at the exposure
  ExposureShift(const ImuEnd& end, double time_offset_s, StateBlocks state, const Eigen::Vector3d& gravity_w);

  /// Parameter blocks at the end of the preintegration.
  [[nodiscard]] const double* pose() const { return pose_.data(); }
  [[nodiscard]] const double* speed_bias() const { return speed_bias_.data(); }

  /// Derivatives by time offset and gravity [m/s^2].
  struct GlobalJacobians {
    Vector15 time_offset = Vector15::Zero();
    Eigen::Matrix<double, 15, 3> gravity = Eigen::Matrix<double, 15, 3>::Zero();
  };

  /// Replaces Jacobians by the state at the end of the preintegration by those by the state at the exposure.
  /// @return the derivatives that depend on this end
  [[nodiscard]] GlobalJacobians apply(PoseJacobian J_pose, SpeedBiasJacobian J_speed_bias) const;

 private:
  double d_;
  Eigen::Matrix3d R_;             ///< at the exposure
  Eigen::Vector3d rate_b_;        ///< w
  Eigen::Vector3d force_b_;       ///< f
  Eigen::Vector3d acceleration_;  ///< a
  Eigen::Matrix<double, 7, 1> pose_;
  Eigen::Matrix<double, 9, 1> speed_bias_;
};

}  // namespace stillpoint
