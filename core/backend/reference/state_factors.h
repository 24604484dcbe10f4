// SPDX-License-Identifier: BSD-3-Clause
/// The residuals of the states, without landmarks, as Ceres cost functions: prior and IMU.
#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include <ceres/cost_function.h>
#include <ceres/sized_cost_function.h>

#include "core/backend/factors/imu_residual.h"
#include "core/backend/factors/linear_prior.h"

namespace stillpoint {

/// The marginalization prior: r(x) = r0 + J (x [-] x0), with one parameter block for each of `prior.blocks`,
/// in their order. The Jacobian is always J, that is, the derivative of [-] is approximated by the one at x0.
/// Keeping the linearization point of the marginalization (first-estimates Jacobian, Huang et al. 2009)
/// preserves the nullspace of the prior: unobservable directions do not gain spurious information.
class PriorFactor final : public ceres::CostFunction {
 public:
  /// @param prior not empty; must outlive the factor
  explicit PriorFactor(const LinearPrior& prior);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const LinearPrior& prior_;
};

/// The IMU preintegration residual, see TimedImuResidual. Jacobians are evaluated with the first estimates in
/// place of the parameter blocks, where given; the residual is not.
class ImuFactor final : public ceres::SizedCostFunction<15, 7, 9, 7, 9, 3, 1> {
 public:
  /// Of the parameter blocks, or null.
  using FirstEstimates = std::array<const double*, 6>;
  using Ends = std::optional<TimedImuResidual::Ends>;

  /// @param imu must outlive the factor; of positive duration
  /// @param ends of the preintegration; none if the states are defined there
  explicit ImuFactor(const Preintegration& imu, const Ends& ends = std::nullopt,
                     const FirstEstimates& first = {})
      : imu_(imu), ends_(ends), first_(first) {}
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
    TimedImuResidual(imu_, ends_ ? &*ends_ : nullptr).evaluate(parameters, residuals, jacobians);
  }

  const Preintegration& imu_;
  Ends ends_;
  FirstEstimates first_;
};

}  // namespace stillpoint
