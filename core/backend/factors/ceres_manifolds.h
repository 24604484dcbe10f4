// SPDX-License-Identifier: BSD-3-Clause
/// Poses (p, q xyzw) and the direction of gravity as manifolds of Ceres, and the options of its problems.
#pragma once

#include <ceres/manifold.h>
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

/// The factors write their Jacobians with respect to the tangent space into the first six of seven columns,
/// so the Jacobian of Plus is [I; 0]: saves one matrix product per residual.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

/// The factors write their Jacobians with respect to the tangent space into the first two of three columns
/// (as for PoseManifold), so the Jacobian of Plus is [I; 0].
class GravityManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 3; }
  int TangentSize() const override { return 2; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace stillpoint
