// SPDX-License-Identifier: BSD-3-Clause
/// Residual between two states and what the IMU measured between them. Qin et al. 2018, Eq. (24).
#pragma once

#include <ceres/sized_cost_function.h>

#include "core/imu/preintegration.h"

namespace stillpoint {

/// Blocks: pose i (p, q xyzw), speed and biases i (v, gyro, accel), pose j, speed and biases j.
/// Jacobians, row by row, are with respect to the tangent space of poses in the first six of seven columns
/// (see PoseManifold); null where they are not wanted.
/// @param imu spans a positive time
void evaluate_imu_residual(const Preintegration& imu, const Eigen::Vector3d& gravity_w,
                           double const* const* parameters, double* residuals, double** jacobians);

/// The same for Ceres.
class ImuFactor final : public ceres::SizedCostFunction<15, 7, 9, 7, 9> {
 public:
  /// @param imu must outlive the factor; spans a positive time
  ImuFactor(const Preintegration& imu, const Eigen::Vector3d& gravity_w) : imu_(imu), gravity_w_(gravity_w) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const Preintegration& imu_;
  Eigen::Vector3d gravity_w_;
};

}  // namespace stillpoint
