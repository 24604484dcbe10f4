// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "core/backend/marginalization/normal_equations.h"
#include "core/backend/solvers/schur_solver.h"
#include "core/backend/solvers/zero_velocity_term.h"

namespace stillpoint {
namespace {

/// Smallest ratio of a pivot to its diagonal entry; below it cancellation makes Cholesky inaccurate and the
/// eigendecomposition is used instead.
constexpr double kMinPivotRatio = 1e-11;

}  // namespace

void SchurSolver::append_columns(BlockRef block) {
  for (int i = 0; i < local_size(block.kind); ++i) columns_.push_back(system_.layout.column(block) + i);
}

/// Computes the Cholesky factor L of the system in the order of `columns_`, in place in S_; rows up to the
/// next multiple of kTile are those of the identity.
/// @return false if it would be inaccurate
bool SchurSolver::factorize_columns() {
  const auto size = static_cast<Eigen::Index>(columns_.size());
  const Eigen::Index padded = (size + kTile - 1) / kTile * kTile;
  S_.resize(padded, padded);
  S_.bottomRows(padded - size).setZero();
  S_.diagonal().tail(padded - size).setOnes();
  for (Eigen::Index row = 0; row < size; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      const auto [smaller, larger] =
          std::minmax(columns_[static_cast<std::size_t>(row)], columns_[static_cast<std::size_t>(column)]);
      S_(row, column) = system_.H(larger, smaller);
    }
  }
  diagonal_ = S_.diagonal();
  dense_.assign(static_cast<std::size_t>(padded / kTile), 0);
  return skyline_factorize(dense_, S_) &&
         (kMinPivotRatio * S_.diagonal().cwiseAbs2().cwiseProduct(diagonal_)).maxCoeff() < 1.0;
}

/// With H = L L^T in the order (m, r), L_rr L_rr^T = H_rr - H_rm H_mm^-1 H_mr.
/// @param prior with its blocks; its matrices are replaced
/// @param marginalized number of leading `columns_` to marginalize; `newton_.states` holds -b
LinearPrior SchurSolver::with_square_root(LinearPrior prior, Eigen::Index marginalized) {
  if (!factorize_columns()) {
    const Eigen::MatrixXd H = system_.H.selfadjointView<Eigen::Lower>();
    const std::vector<int> marginalized_columns(columns_.begin(), columns_.begin() + marginalized);
    const std::vector<int> remaining_columns(columns_.begin() + marginalized, columns_.end());
    const SquareRoot root = eliminate(H, -newton_.states, marginalized_columns, remaining_columns);
    prior.jacobian = root.jacobian;
    prior.residual = root.residual;
    return prior;
  }
  step_.states.resize(S_.rows());
  step_.states.tail(S_.rows() - static_cast<Eigen::Index>(columns_.size())).setZero();
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    step_.states[static_cast<Eigen::Index>(i)] = -newton_.states[columns_[i]];
  }
  skyline_forward(dense_, S_, step_.states);
  S_.diagonal() = S_.diagonal().cwiseInverse();
  const Eigen::Index remaining = static_cast<Eigen::Index>(columns_.size()) - marginalized;
  prior.residual = step_.states.segment(marginalized, remaining);
  prior.jacobian.resize(remaining, remaining);
  prior.jacobian.setZero();
  prior.jacobian.triangularView<Eigen::Upper>() =
      S_.block(marginalized, marginalized, remaining, remaining).transpose();
  return prior;
}

LinearPrior SchurSolver::marginalize_oldest(const Window& window, const BackendConfig& config,
                                            double focal_px, LinearPrior recycled) {
  blocks_.assign(window);
  visual_.read(window, config, focal_px, LandmarkSelection::kHostedByOldest);
  system_.reset(ReducedLayout(static_cast<int>(window.frames.size()), window.inertial,
                              marginalized_globals(window, config)));
  prior_.read(window.prior);
  prior_.add_to(system_, blocks_);
  const Linearization at = linearize_at(blocks_, window, config, point_);
  if (window.newest() >= 1 && has_imu_term(window, 1)) add_imu_term(window, 1, at, system_);
  if (has_zero_velocity_term(window, 0)) add_zero_velocity_term(0, config, blocks_, system_);
  visual_.add_to(system_, at);
  newton_.states = -system_.g;
  visual_.eliminate(0.0, system_.H, newton_.states);

  columns_.clear();
  append_columns({BlockKind::kPose, 0});
  if (window.inertial) append_columns({BlockKind::kSpeedBias, 0});
  const auto marginalized = static_cast<Eigen::Index>(columns_.size());
  LinearPrior prior = std::move(recycled);
  prior.blocks.clear();
  prior_blocks_ = candidate_blocks(window, config, std::move(prior_blocks_));
  for (const BlockRef block : prior_blocks_) {
    const int size = local_size(block.kind);
    if (system_.H.diagonal().segment(system_.layout.column(block), size).isZero(0.0)) continue;
    append_columns(block);
    prior.blocks.push_back(prior_block_after_slide(block, at.point));
  }
  if (prior.blocks.empty()) return prior;
  prior = with_square_root(std::move(prior), marginalized);
  if (at.at_first_estimates()) move_residual_to_linearization(blocks_, prior);
  return prior;
}

}  // namespace stillpoint
