// SPDX-License-Identifier: BSD-3-Clause
/// The IMU preintegration residual as a Ceres cost function.
#pragma once

#include <ceres/sized_cost_function.h>

#include "core/backend/factors/imu_residual.h"

namespace stillpoint {

/// See ImuResidual; a fifth parameter block is gravity.
class ImuFactor final : public ceres::SizedCostFunction<15, 7, 9, 7, 9, 3> {
 public:
  /// @param imu must outlive the factor; of positive duration
  explicit ImuFactor(const Preintegration& imu) : imu_(imu) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const ImuResidual residual(imu_, Eigen::Vector3d(parameters[4]));
    residual.evaluate(parameters, residuals, jacobians);
    if (jacobians != nullptr && jacobians[4] != nullptr)
      residual.evaluate_gravity_jacobian(parameters[0], jacobians[4]);
    return true;
  }

 private:
  const Preintegration& imu_;
};

}  // namespace stillpoint
