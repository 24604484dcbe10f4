// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>

#include "core/backend/marginalization/normal_equations.h"
#include "core/backend/solvers/ceres_solver.h"
#include "core/backend/solvers/newest_covariance.h"

namespace stillpoint {
namespace {

/// All variable states; those of `newest_blocks` first.
std::vector<BlockRef> variable_blocks(const Window& window, const BackendConfig& config) {
  std::vector<BlockRef> blocks = newest_blocks(window, config);
  for (int frame = 0; frame < window.newest(); ++frame) {
    blocks.push_back({BlockKind::kPose, frame});
    if (window.inertial) blocks.push_back({BlockKind::kSpeedBias, frame});
  }
  return blocks;
}

}  // namespace

std::optional<StateCovariance> CeresSolver::newest_covariance(const Window& window,
                                                              const BackendConfig& config, double focal_px) {
  const NormalEquations equations = linearize_all(window, config, focal_px, ParameterBlocks(window));
  std::vector<int> columns;
  for (const BlockRef block : variable_blocks(window, config)) {
    for (int i = 0; i < local_size(block.kind); ++i) columns.push_back(equations.layout.column(block) + i);
  }
  const Eigen::MatrixXd H = equations.H(columns, columns);
  const Eigen::VectorXd unit = H.diagonal().cwiseSqrt().cwiseInverse();  // makes the diagonal entries 1
  const Eigen::LLT<Eigen::MatrixXd> factor(unit.asDiagonal() * H * unit.asDiagonal());
  if (!unit.allFinite() || factor.info() != Eigen::Success) return std::nullopt;

  const std::vector<BlockRef> blocks = newest_blocks(window, config);
  Eigen::Index size = 0;
  for (const BlockRef block : blocks) size += local_size(block.kind);
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(H.rows(), size)).topRows(size);
  return state_covariance(blocks, unit.head(size).asDiagonal() * inverse * unit.head(size).asDiagonal());
}

}  // namespace stillpoint
