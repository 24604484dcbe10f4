// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/backend/solvers/newest_covariance.h"
#include "core/backend/solvers/schur_solver.h"

namespace stillpoint {

std::optional<StateCovariance> SchurSolver::newest_covariance(const Window& window,
                                                              const BackendConfig& config, double focal_px) {
  read(window, config, focal_px);
  static_cast<void>(linearize(window, config));
  S_ = system_.H;
  newton_.states = -system_.g;
  visual_.eliminate(0.0, S_, newton_.states);
  S_.diagonal().tail(layout_.padding()).setOnes();
  if (!skyline_factorize(system_.first, S_)) return std::nullopt;

  prior_blocks_ = newest_blocks(window, config, std::move(prior_blocks_));
  columns_.clear();
  for (const BlockRef block : prior_blocks_) append_columns(block);
  unit_columns_.resize(layout_.size(), ForwardColumns::ColsAtCompileTime);
  unit_columns_.setZero();
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    unit_columns_(columns_[i], static_cast<Eigen::Index>(i)) = 1.0;
  }
  const int begin = *std::min_element(columns_.begin(), columns_.end()) / kTile * kTile;
  skyline_forward(system_.first, S_, begin, unit_columns_);
  const auto used = unit_columns_.leftCols(static_cast<Eigen::Index>(columns_.size()));
  const NewestMatrix covariance = used.transpose().lazyProduct(used);
  if (!covariance.allFinite()) return std::nullopt;
  return state_covariance(prior_blocks_, covariance);
}

}  // namespace stillpoint
