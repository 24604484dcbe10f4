// SPDX-License-Identifier: BSD-3-Clause
/// Poses (p, q xyzw) as a manifold with 6 tangent directions: p + d, q * Exp(theta).
#pragma once

#include <ceres/manifold.h>

namespace stillpoint {

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

}  // namespace stillpoint
