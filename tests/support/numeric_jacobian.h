// SPDX-License-Identifier: BSD-3-Clause
/// Numeric Jacobians on the tangent space, for comparison with analytic ones.
#pragma once

#include <vector>

#include <ceres/cost_function.h>
#include <Eigen/Core>

#include "core/backend/factors/ceres_manifolds.h"

namespace stillpoint {

/// Parameter blocks of a cost function; blocks of 7 values are poses, of 3 gravity.
using Blocks = std::vector<std::vector<double>>;

inline std::vector<const double*> addresses(const Blocks& blocks) {
  std::vector<const double*> pointers;
  for (const std::vector<double>& block : blocks) pointers.push_back(block.data());
  return pointers;
}

inline Eigen::VectorXd residual_at(const ceres::CostFunction& cost, const Blocks& blocks) {
  Eigen::VectorXd residual(cost.num_residuals());
  cost.Evaluate(addresses(blocks).data(), residual.data(), nullptr);
  return residual;
}

inline int tangent_size(const std::vector<double>& block) {
  return static_cast<int>(block.size()) - (block.size() == 7 || block.size() == 3);
}

inline void move(std::vector<double>& block, int direction, double step) {
  double delta[6] = {};
  const std::vector<double> before = block;
  if (block.size() == 7) {
    delta[direction] = step;
    PoseManifold().Plus(before.data(), delta, block.data());
  } else if (block.size() == 3) {
    delta[direction] = step;
    GravityManifold().Plus(before.data(), delta, block.data());
  } else {
    block[static_cast<std::size_t>(direction)] += step;
  }
}

/// Central differences; one matrix per block, tangent columns.
inline std::vector<Eigen::MatrixXd> numeric_jacobians(const ceres::CostFunction& cost, const Blocks& blocks,
                                                      double step = 1e-6) {
  std::vector<Eigen::MatrixXd> jacobians;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    Eigen::MatrixXd J(cost.num_residuals(), tangent_size(blocks[i]));
    for (int k = 0; k < J.cols(); ++k) {
      Blocks up = blocks, down = blocks;
      move(up[i], k, step);
      move(down[i], k, -step);
      J.col(k) = (residual_at(cost, up) - residual_at(cost, down)) / (2.0 * step);
    }
    jacobians.push_back(J);
  }
  return jacobians;
}

inline std::vector<Eigen::MatrixXd> analytic_jacobians(const ceres::CostFunction& cost,
                                                       const Blocks& blocks) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<RowMajor> full;
  for (const std::vector<double>& block : blocks) full.emplace_back(cost.num_residuals(), block.size());
  std::vector<double*> pointers;
  for (RowMajor& J : full) pointers.push_back(J.data());
  Eigen::VectorXd residual(cost.num_residuals());
  cost.Evaluate(addresses(blocks).data(), residual.data(), pointers.data());
  std::vector<Eigen::MatrixXd> jacobians;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    jacobians.emplace_back(full[i].leftCols(tangent_size(blocks[i])));
  return jacobians;
}

/// Largest difference over all blocks, relative to the largest numeric entry of the block.
inline double jacobian_error(const ceres::CostFunction& cost, const Blocks& blocks, double step = 1e-6) {
  const std::vector<Eigen::MatrixXd> numeric = numeric_jacobians(cost, blocks, step);
  const std::vector<Eigen::MatrixXd> analytic = analytic_jacobians(cost, blocks);
  double worst = 0.0;
  for (std::size_t i = 0; i < numeric.size(); ++i) {
    const double scale = std::max(1.0, numeric[i].cwiseAbs().maxCoeff());
    worst = std::max(worst, (numeric[i] - analytic[i]).cwiseAbs().maxCoeff() / scale);
  }
  return worst;
}

}  // namespace stillpoint
