// SPDX-License-Identifier: BSD-3-Clause
/// Options of the Ceres problems.
#pragma once

#include <ceres/problem.h>

namespace stillpoint {

/// A problem whose costs, losses and manifolds belong to the caller, without Ceres' checks of their use.
inline ceres::Problem::Options problem_options() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

}  // namespace stillpoint
