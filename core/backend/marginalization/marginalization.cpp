// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/marginalization/marginalization.h"

#include <utility>

#include "core/backend/marginalization/normal_equations.h"
#include "core/backend/solvers/schur_solver.h"
#include "core/base/error.h"

namespace stillpoint {
namespace {

std::vector<int> columns_of(int first, int size) {
  std::vector<int> columns(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) columns[static_cast<std::size_t>(i)] = first + i;
  return columns;
}

void append(std::vector<int>& to, const std::vector<int>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

NormalEquations linearize_oldest(const Window& window, const BackendConfig& config, double focal_px,
                                 ParameterBlocks& blocks) {
  NormalEquations equations(static_cast<int>(window.frames.size()));
  ResidualBuilder builder(window, config, focal_px);
  std::vector<Residual> group;
  builder.add_prior(group);
  if (window.newest() >= 1) builder.add_imu(1, group);
  equations.add(group, blocks, false);
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    const Landmark& landmark = window.landmarks[i];
    if (landmark.host != 0 || !is_usable(landmark)) continue;
    group.clear();
    builder.add_landmark(static_cast<int>(i), group);
    equations.add(group, blocks, has_constant_depth(landmark, config));
  }
  return equations;
}

}  // namespace

std::vector<BlockRef> candidate_blocks(const Window& window, std::vector<BlockRef> recycled) {
  std::vector<BlockRef> blocks = std::move(recycled);
  blocks.clear();
  for (int frame = 1; frame <= window.newest(); ++frame) blocks.push_back({BlockKind::kPose, frame});
  if (!window.inertial) return blocks;
  for (int frame = 1; frame <= window.newest(); ++frame) blocks.push_back({BlockKind::kSpeedBias, frame});
  return blocks;
}

LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config, double focal_px) {
  SchurSolver solver;
  return marginalize_oldest(window, config, focal_px, solver);
}

LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config, double focal_px,
                               SchurSolver& solver) {
  if (config.solver == WindowSolverKind::kSchur) return solver.marginalize_oldest(window, config, focal_px);
  ParameterBlocks blocks(window);
  const NormalEquations equations = linearize_oldest(window, config, focal_px, blocks);
  const StateLayout& layout = equations.layout;

  std::vector<int> marginalized = columns_of(layout.column({BlockKind::kPose, 0}), 6);
  if (window.inertial) append(marginalized, columns_of(layout.column({BlockKind::kSpeedBias, 0}), 9));

  LinearPrior prior;
  std::vector<int> remaining;
  for (const BlockRef block : candidate_blocks(window)) {
    const int column = layout.column(block);
    const int size = local_size(block.kind);
    if (equations.H.diagonal().segment(column, size).isZero(0.0)) continue;
    append(remaining, columns_of(column, size));
    const Eigen::Map<const Eigen::VectorXd> now(block_address(blocks, block), global_size(block.kind));
    prior.blocks.push_back({block.kind, block.frame - 1, now});
  }
  if (remaining.empty()) return prior;
  SquareRoot root = eliminate(equations.H, equations.b, marginalized, remaining);
  prior.jacobian = std::move(root.jacobian);
  prior.residual = std::move(root.residual);
  return prior;
}

/// Splits blocks and columns of the prior into those of the frame and the others.
void FrameMarginalizer::split(int frame, const LinearPrior& prior) {
  const Eigen::Index rows = prior.jacobian.rows();
  int marginalized = 0;
  for (const PriorBlock& block : prior.blocks)
    marginalized += block.frame == frame ? local_size(block.kind) : 0;
  STILLPOINT_CHECK(rows <= kMaxRows && marginalized <= kMaxColumns);
  marginalized_columns_.resize(rows, marginalized);
  remaining_columns_.resize(rows, prior.jacobian.cols() - marginalized + 1);
  result_.blocks.clear();
  int from = 0, to_marginalized = 0, to_remaining = 0;
  for (const PriorBlock& block : prior.blocks) {
    const int size = local_size(block.kind);
    if (block.frame == frame) {
      marginalized_columns_.middleCols(to_marginalized, size) = prior.jacobian.middleCols(from, size);
      to_marginalized += size;
    } else {
      remaining_columns_.middleCols(to_remaining, size) = prior.jacobian.middleCols(from, size);
      to_remaining += size;
      result_.blocks.push_back(block);
      if (block.frame > frame) --result_.blocks.back().frame;
    }
    from += size;
  }
  remaining_columns_.col(to_remaining) = prior.residual;
}

void FrameMarginalizer::remove(int frame, LinearPrior& prior) {
  split(frame, prior);
  Eigen::Index rank = 0;
  if (marginalized_columns_.cols() > 0) {
    // After applying Q^T only the first `rank` rows depend on the marginalized columns.
    qr_.compute(marginalized_columns_);
    Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kMaxRows + 1> workspace;
    Eigen::Map<Eigen::MatrixXd>& rotated = remaining_columns_;
    qr_.householderQ().adjoint().applyThisOnTheLeft(rotated, workspace);
    rank = qr_.rank();
  }
  const Eigen::Index rows = remaining_columns_.rows() - rank;
  result_.jacobian = remaining_columns_.bottomLeftCorner(rows, remaining_columns_.cols() - 1);
  result_.residual = remaining_columns_.col(remaining_columns_.cols() - 1).tail(rows);
  std::swap(prior, result_);
}

}  // namespace stillpoint
