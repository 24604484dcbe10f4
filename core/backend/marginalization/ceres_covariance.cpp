// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <span>

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

std::vector<int> columns_of(std::span<const BlockRef> blocks, const StateLayout& layout) {
  std::vector<int> columns;
  for (const BlockRef block : blocks) {
    for (int i = 0; i < local_size(block.kind); ++i) columns.push_back(layout.column(block) + i);
  }
  return columns;
}

}  // namespace

std::optional<WindowCovariance> CeresSolver::covariance(const Window& window, const BackendConfig& config,
                                                        double focal_px, bool oldest_motion) {
  const NormalEquations equations = linearize_all(window, config, focal_px, ParameterBlocks(window));
  const std::vector<int> columns = columns_of(variable_blocks(window, config), equations.layout);
  const Eigen::MatrixXd H = equations.H(columns, columns);
  const Eigen::VectorXd unit = H.diagonal().cwiseSqrt().cwiseInverse();  // makes the diagonal entries 1
  const Eigen::LLT<Eigen::MatrixXd> factor(unit.asDiagonal() * H * unit.asDiagonal());
  if (!unit.allFinite() || factor.info() != Eigen::Success) return std::nullopt;

  const Eigen::MatrixXd inverse =
      unit.asDiagonal() * factor.solve(Eigen::MatrixXd::Identity(H.rows(), H.rows())) * unit.asDiagonal();
  const auto inverse_blocks = [&](std::span<const BlockRef> blocks) {
    std::vector<Eigen::Index> selected;
    for (const int column : columns_of(blocks, equations.layout))
      selected.push_back(std::ranges::find(columns, column) - columns.begin());
    return NewestMatrix(inverse(selected, selected));
  };
  const std::vector<BlockRef> blocks = newest_blocks(window, config);
  WindowCovariance result{.newest = state_covariance(blocks, inverse_blocks(blocks))};
  const Eigen::VectorXd step = -inverse * equations.b(columns);
  result.rig =
      rig_contradiction(window.agrees_with_rig, blocks, inverse_blocks(blocks),
                        step.head(static_cast<Eigen::Index>(columns_of(blocks, equations.layout).size())));
  if (oldest_motion) result.oldest_motion = oldest_motion_of(window, inverse_blocks(kOldestPoses));
  return result;
}

}  // namespace stillpoint
