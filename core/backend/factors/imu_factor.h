// SPDX-License-Identifier: BSD-3-Clause
/// IMU preintegration residual between two states. Paper Sec. II; Qin et al. 2018, Eq. (24).
#pragma once

#include <ceres/sized_cost_function.h>

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
/// @param imu of positive duration
void evaluate_imu_residual(const Preintegration& imu, const Eigen::Vector3d& gravity_w,
                           double const* const* parameters, double* residuals, double** jacobians);

/// The residual as a Ceres cost function.
class ImuFactor final : public ceres::SizedCostFunction<15, 7, 9, 7, 9> {
 public:
  /// @param imu must outlive the factor; of positive duration
  ImuFactor(const Preintegration& imu, const Eigen::Vector3d& gravity_w) : imu_(imu), gravity_w_(gravity_w) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const Preintegration& imu_;
  Eigen::Vector3d gravity_w_;
};

}  // namespace stillpoint
