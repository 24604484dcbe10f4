// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/reference/state_factors.h"

namespace stillpoint {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

PriorFactor::PriorFactor(const LinearPrior& prior) : prior_(prior) {
  set_num_residuals(static_cast<int>(prior.residual.size()));
  for (const PriorBlock& block : prior.blocks)
    mutable_parameter_block_sizes()->push_back(global_size(block.kind));
}

bool PriorFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  Eigen::VectorXd difference(prior_.jacobian.cols());
  int column = 0;
  for (std::size_t i = 0; i < prior_.blocks.size(); ++i) {
    const PriorBlock& block = prior_.blocks[i];
    const int local = local_size(block.kind);
    difference.segment(column, local) = block_difference(block.kind, parameters[i], block.linearization);
    if (jacobians != nullptr && jacobians[i] != nullptr) {
      Eigen::Map<RowMajorMatrix> jacobian(jacobians[i], prior_.residual.size(), global_size(block.kind));
      jacobian.setZero();
      jacobian.leftCols(local) = prior_.jacobian.middleCols(column, local);
    }
    column += local;
  }
  Eigen::Map<Eigen::VectorXd>(residuals, prior_.residual.size()) =
      prior_.residual + prior_.jacobian * difference;
  return true;
}

}  // namespace stillpoint
