// SPDX-License-Identifier: BSD-3-Clause
/// IMU preintegration residual between two states, shared by the Ceres factor and the Schur solver. Paper
/// Sec. II; Qin et al. 2018, Eq. (24).
#pragma once

#include <array>

#include "core/backend/factors/exposure_shift.h"
#include "core/imu/preintegration.h"

namespace stillpoint {

/// With the preintegrated deltas of `imu` corrected to first order for the biases at i (see Preintegration),
/// dt its duration and g gravity in the world, the residual before whitening is
///
///   r_p  = R_i^T (p_j - p_i - v_i dt - 1/2 g dt^2) - delta_p(bg_i, ba_i)
///   r_q  = Log( delta_q(bg_i)^-1 q_i^-1 q_j )
///   r_v  = R_i^T (v_j - v_i - g dt) - delta_v(bg_i, ba_i)
///   r_bg = bg_j - bg_i
///   r_ba = ba_j - ba_i
///
/// in the order of ImuErrorIndex. The output is W r with W^T W = P^-1, P the preintegrated covariance.
///
/// Parameter blocks: pose i (p, q xyzw), velocity and biases i (v, gyro, accel), pose j, velocity and biases
/// j.
/// Jacobians are row-major; those of poses hold the tangent space in the first six of seven columns (see
/// PoseManifold). A null pointer skips a Jacobian.
class ImuResidual {
 public:
  /// @param imu must outlive the residual; of positive duration
  ImuResidual(const Preintegration& imu, const Eigen::Vector3d& gravity_w)
      : imu_(imu), gravity_w_(gravity_w) {}

  /// Writes the residual, 15 values, and the Jacobians. @param jacobians null = none
  void evaluate(double const* const* parameters, double* residuals, double** jacobians) const;

  /// Writes the derivative of W r by the tangent vector d of gravity (see gravity_direction.h), 15x3
  /// row-major, into the first two of three columns (see GravityManifold). Before whitening it is
  ///
  ///   d r_p / d d = -1/2 dt^2 R_i^T dg/dd,    d r_v / d d = -dt R_i^T dg/dd.
  void evaluate_gravity_jacobian(const double* pose_i, double* jacobian) const;

 private:
  const Preintegration& imu_;
  Eigen::Vector3d gravity_w_;
};

/// ImuResidual of states at the exposures of two frames, which are shifted to the ends of the preintegration
/// (see ExposureShift).
///
/// Parameter blocks: those of ImuResidual, gravity, time offset. Jacobians are row-major with 7, 9, 7, 9, 3
/// and 1 columns; those of poses and gravity hold the tangent space in the first six and two columns.
class TimedImuResidual {
 public:
  using Ends = std::array<ImuEnd, 2>;

  /// @param imu must outlive the residual; of positive duration
  /// @param ends of the preintegration; null if the states are defined there: then the time offset has no
  /// influence
  TimedImuResidual(const Preintegration& imu, const Ends* ends) : imu_(imu), ends_(ends) {}

  /// Writes the residual, 15 values, and the Jacobians.
  /// @param jacobians null = none; a null pointer among them skips one
  void evaluate(double const* const* parameters, double* residuals, double** jacobians) const;

 private:
  void evaluate_shifted(double const* const* parameters, double* residuals, double** jacobians) const;

  const Preintegration& imu_;
  const Ends* ends_;
};

}  // namespace stillpoint
