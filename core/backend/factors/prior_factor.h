// SPDX-License-Identifier: BSD-3-Clause
/// The marginalisation prior as a residual of the solve.
#pragma once

#include <ceres/cost_function.h>

#include "core/backend/factors/linear_prior.h"

namespace stillpoint {

/// One parameter block for each of `prior.blocks`, in their order. The Jacobian of the rotation is taken as
/// that at the linearisation point: first estimates, so that marginalised information is not counted as new
/// (Huang et al. 2009).
class PriorFactor final : public ceres::CostFunction {
 public:
  /// @param prior not empty; must outlive the factor
  explicit PriorFactor(const LinearPrior& prior);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const LinearPrior& prior_;
};

}  // namespace stillpoint
