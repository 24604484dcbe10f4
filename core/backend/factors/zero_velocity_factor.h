// SPDX-License-Identifier: BSD-3-Clause
/// Residual of a state at rest. ceres::NormalPrior would do, but owns Eigen matrices: with AVX, Eigen
/// allocates them differently here than in the library of Ceres, which is built for the baseline.
#pragma once

#include <algorithm>

#include <ceres/sized_cost_function.h>

namespace stillpoint {

/// r = v / sigma of a block (v, gyroscope bias, accelerometer bias), v in [m/s].
class ZeroVelocityFactor final : public ceres::SizedCostFunction<3, 9> {
 public:
  /// @param sigma_m_per_s > 0
  explicit ZeroVelocityFactor(double sigma_m_per_s) : weight_(1.0 / sigma_m_per_s) {}

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    for (int i = 0; i < 3; ++i) residuals[i] = weight_ * parameters[0][i];
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    std::fill_n(jacobians[0], 27, 0.0);
    for (int i = 0; i < 3; ++i) jacobians[0][9 * i + i] = weight_;
    return true;
  }

 private:
  double weight_;
};

}  // namespace stillpoint
