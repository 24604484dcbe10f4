// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>

#include "core/backend/marginalization.h"
#include "core/backend/normal_equations.h"
#include "core/backend/schur/schur_solver.h"

namespace stillpoint {
namespace {

/// A pivot below this share of its diagonal has lost its digits: the eigenvalues then say what is known.
constexpr double kMinPivotShare = 1e-11;

std::vector<int> columns_of(std::span<const BlockRef> blocks, const ReducedLayout& layout) {
  std::vector<int> columns;
  for (const BlockRef block : blocks) {
    for (int i = 0; i < local_size(block.kind); ++i) columns.push_back(layout.column(block) + i);
  }
  return columns;
}

/// The system in the order of `columns`, which are the first `gone` to leave and then those to stay.
/// With H = L L^T the part of L that is left is the root of what is left of H.
SquareRoot root_of_rest(const RowMajorMatrix& H, const Eigen::VectorXd& b, const std::vector<int>& columns,
                        Eigen::Index gone) {
  const auto size = static_cast<Eigen::Index>(columns.size());
  RowMajorMatrix L = H(columns, columns);
  const Eigen::VectorXd diagonal = L.diagonal();
  const std::vector<int> dense(columns.size() / kTile, 0);
  const bool definite = skyline_factorize(dense, L);
  const bool exact =
      definite && (kMinPivotShare * L.diagonal().cwiseAbs2().cwiseProduct(diagonal)).maxCoeff() < 1.0;
  if (!exact) {
    const std::vector<int> leaving(columns.begin(), columns.begin() + gone);
    const std::vector<int> staying(columns.begin() + gone, columns.end());
    return eliminate(H, b, leaving, staying);
  }
  Eigen::VectorXd y = b(columns);
  skyline_forward(dense, L, y);
  L.diagonal() = L.diagonal().cwiseInverse().eval();
  const Eigen::Index kept = size - gone;
  SquareRoot root{Eigen::MatrixXd::Zero(kept, kept), y.tail(kept)};
  root.jacobian.triangularView<Eigen::Upper>() = L.bottomRightCorner(kept, kept).transpose();
  return root;
}

}  // namespace

LinearPrior SchurSolver::marginalize_oldest(const Window& window, const BackendConfig& config,
                                            double focal_px) {
  blocks_.assign(window);
  visual_.read(window, config, focal_px, LandmarkPart::kHostedByOldest);
  system_.reset(ReducedLayout(static_cast<int>(window.frames.size()), window.inertial, {}));
  prior_.read(window.prior);
  prior_.add_to(system_, blocks_);
  if (window.newest() >= 1 && has_imu_term(window, 1)) add_imu_term(window, 1, blocks_, system_);
  visual_.add_to(system_, blocks_);
  Eigen::VectorXd rhs = -system_.g;
  visual_.eliminate(0.0, system_.H, rhs);
  system_.H.triangularView<Eigen::StrictlyUpper>() = system_.H.transpose();

  std::vector<BlockRef> order = {{BlockKind::kPose, 0}};
  if (window.inertial) order.push_back({BlockKind::kSpeedBias, 0});
  const std::size_t gone = order.size();
  LinearPrior prior;
  for (const BlockRef block : candidate_blocks(window)) {
    const int size = local_size(block.kind);
    if (system_.H.diagonal().segment(system_.layout.column(block), size).isZero(0.0)) continue;
    order.push_back(block);
    prior.blocks.push_back(
        {block.kind, block.frame - 1,
         Eigen::Map<const BlockVector>(block_address(blocks_, block), global_size(block.kind))});
  }
  if (prior.blocks.empty()) return prior;
  const std::vector<int> columns = columns_of(order, system_.layout);
  const std::size_t gone_columns = columns_of(std::span(order).first(gone), system_.layout).size();
  SquareRoot root = root_of_rest(system_.H, -rhs, columns, static_cast<Eigen::Index>(gone_columns));
  prior.jacobian = std::move(root.jacobian);
  prior.residual = std::move(root.residual);
  return prior;
}

}  // namespace stillpoint
