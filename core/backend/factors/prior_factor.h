// SPDX-License-Identifier: BSD-3-Clause
/// The marginalization prior as a Ceres cost function.
#pragma once

#include <ceres/cost_function.h>

#include "core/backend/factors/linear_prior.h"

namespace stillpoint {

/// r(x) = r0 + J (x [-] x0), with one parameter block for each of `prior.blocks`, in their order. The
/// Jacobian is always J, that is, the derivative of [-] is approximated by the one at x0. Keeping the
/// linearization point of the marginalization (first-estimates Jacobian, Huang et al. 2009) preserves the
/// nullspace of the prior: unobservable directions do not gain spurious information.
class PriorFactor final : public ceres::CostFunction {
 public:
  /// @param prior not empty; must outlive the factor
  explicit PriorFactor(const LinearPrior& prior);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const LinearPrior& prior_;
};

}  // namespace stillpoint
