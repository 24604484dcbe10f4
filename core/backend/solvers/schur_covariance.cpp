// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>

#include "core/backend/solvers/newest_covariance.h"
#include "core/backend/solvers/schur_solver.h"

namespace stillpoint {

std::optional<WindowCovariance> SchurSolver::covariance(const Window& window, const BackendConfig& config,
                                                        double focal_px, bool oldest_motion) {
  read(window, config, focal_px, variable_globals(window, config));
  static_cast<void>(linearize(window, config));
  system_.copy_profile_to(S_);
  newton_.states = -system_.g;
  visual_.eliminate(0.0, S_, newton_.states);
  S_.diagonal().tail(layout_.padding()).setOnes();
  if (!skyline_factorize(system_.first, S_)) return std::nullopt;

  prior_blocks_ = newest_blocks(window, config, std::move(prior_blocks_));
  const NewestMatrix newest = inverse_blocks(prior_blocks_);
  if (!newest.allFinite()) return std::nullopt;
  WindowCovariance result{.newest = state_covariance(prior_blocks_, newest)};
  if (window.agrees_with_rig.any()) {
    skyline_solve(system_.first, S_, newton_.states);
    const NewestVector step = newton_.states(columns_);
    result.rig = rig_contradiction(window.agrees_with_rig, prior_blocks_, newest, step);
  }
  if (oldest_motion) result.oldest_motion = oldest_motion_of(window, inverse_blocks(kOldestPoses));
  return result;
}

/// The rows and columns of the blocks in S^-1.
NewestMatrix SchurSolver::inverse_blocks(std::span<const BlockRef> blocks) {
  columns_.clear();
  for (const BlockRef block : blocks) append_columns(block);
  unit_columns_.resize(layout_.size(), ForwardColumns::ColsAtCompileTime);
  unit_columns_.setZero();
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    unit_columns_(columns_[i], static_cast<Eigen::Index>(i)) = 1.0;
  }
  const int begin = *std::min_element(columns_.begin(), columns_.end()) / kTile * kTile;
  skyline_forward(system_.first, S_, begin, unit_columns_);
  const auto used = unit_columns_.leftCols(static_cast<Eigen::Index>(columns_.size()));
  return used.transpose().lazyProduct(used);
}

}  // namespace stillpoint
