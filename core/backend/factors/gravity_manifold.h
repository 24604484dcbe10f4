// SPDX-License-Identifier: BSD-3-Clause
/// The direction of gravity as a Ceres manifold with two tangent directions, see gravity_direction.h.
#pragma once

#include <ceres/manifold.h>

namespace stillpoint {

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
