// SPDX-License-Identifier: BSD-3-Clause
/// The IMU preintegration residual as a Ceres cost function.
#pragma once

#include <array>

#include <ceres/sized_cost_function.h>

#include "core/backend/factors/imu_residual.h"

namespace stillpoint {

/// See ImuResidual; a fifth parameter block is gravity. Jacobians are evaluated with the first estimates in
/// place of the parameter blocks, where given; the residual is not.
class ImuFactor final : public ceres::SizedCostFunction<15, 7, 9, 7, 9, 3> {
 public:
  /// Of the parameter blocks, or null.
  using FirstEstimates = std::array<const double*, 5>;

  /// @param imu must outlive the factor; of positive duration
  explicit ImuFactor(const Preintegration& imu, const FirstEstimates& first = {})
      : imu_(imu), first_(first) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    evaluate_at(parameters, residuals, jacobians);
    if (jacobians == nullptr || first_ == FirstEstimates{}) return true;
    FirstEstimates point = first_;
    for (std::size_t i = 0; i < point.size(); ++i) {
      if (point[i] == nullptr) point[i] = parameters[i];
    }
    Vector15 unused;
    evaluate_at(point.data(), unused.data(), jacobians);
    return true;
  }

 private:
  void evaluate_at(double const* const* parameters, double* residuals, double** jacobians) const {
    const ImuResidual residual(imu_, Eigen::Vector3d(parameters[4]));
    residual.evaluate(parameters, residuals, jacobians);
    if (jacobians != nullptr && jacobians[4] != nullptr)
      residual.evaluate_gravity_jacobian(parameters[0], jacobians[4]);
  }

  const Preintegration& imu_;
  FirstEstimates first_;
};

}  // namespace stillpoint
