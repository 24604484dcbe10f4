// SPDX-License-Identifier: BSD-3-Clause
/// The IMU preintegration residual as a Ceres cost function.
#pragma once

#include <ceres/sized_cost_function.h>

#include "core/backend/factors/imu_residual.h"

namespace stillpoint {

/// See ImuResidual.
class ImuFactor final : public ceres::SizedCostFunction<15, 7, 9, 7, 9> {
 public:
  /// @param imu must outlive the factor; of positive duration
  ImuFactor(const Preintegration& imu, const Eigen::Vector3d& gravity_w) : residual_(imu, gravity_w) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    residual_.evaluate(parameters, residuals, jacobians);
    return true;
  }

 private:
  ImuResidual residual_;
};

}  // namespace stillpoint
