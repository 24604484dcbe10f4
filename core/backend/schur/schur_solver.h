// SPDX-License-Identifier: BSD-3-Clause
/// The state optimisation written for the shape of the window: landmarks eliminated on the fly, then Powell's
/// dogleg. Paper Sec. II (state optimisation).
#pragma once

#include <utility>
#include <vector>

#include "core/backend/schur/visual_terms.h"
#include "core/backend/window_solver.h"

namespace stillpoint {

/// Minimises the same residuals as Ceres does (tests hold both to the same normal equations); kept between
/// solves for its memory only: the result depends on nothing but the arguments.
class SchurSolver {
 public:
  /// Moves the window's states; see `solve_window`. Lost depths stay as the solve left them.
  [[nodiscard]] SolveReport solve(Window& window, const BackendConfig& config, double focal_px);

  /// See `marginalize_oldest`; by the Cholesky root of all states instead of eigenvalues.
  [[nodiscard]] LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config,
                                               double focal_px);
  /// Takes a prior that nobody needs any more, for the memory of the next.
  void reuse(LinearPrior spent) { spare_ = std::move(spent); }

 private:
  /// A direction in the space of all states and free landmarks.
  struct Direction {
    KeptVector states;
    KeptVector landmarks;
  };

  void read(const Window& window, const BackendConfig& config, double focal_px);
  [[nodiscard]] double linearize(const Window& window);
  [[nodiscard]] double cost_at(const Window& window, ParameterBlocks& blocks);
  [[nodiscard]] bool find_newton_step();
  void choose_step(double radius);
  [[nodiscard]] double scaled_norm(const Direction& direction) const;
  [[nodiscard]] double curvature(const Direction& direction);
  [[nodiscard]] double predicted_decrease(const Direction& direction);
  void place_candidate();
  [[nodiscard]] SolveReport iterate(const Window& window, const BackendConfig& config);
  void append_columns(BlockRef block);
  [[nodiscard]] bool factorize_columns();
  void write_root_of_rest(Eigen::Index gone, LinearPrior& prior);

  ReducedLayout layout_;
  ReducedSystem system_;
  VisualTerms visual_;
  PriorTerm prior_;
  PriorTerm calibration_;
  ParameterBlocks blocks_;
  ParameterBlocks candidate_;
  KeptMatrix<RowMajorMatrix> S_;
  Direction scale_squared_;  // curvature along each axis
  Direction newton_;
  Direction cauchy_;  // to the minimum along the gradient
  Direction step_;
  KeptVector seen_;           // what a direction of states does to the gradient of the landmarks
  KeptVector product_;        // H times a direction of states
  std::vector<int> columns_;  // of the states that leave, then of those that stay
  std::vector<int> dense_;    // a profile that begins at the first column
  std::vector<BlockRef> kept_;
  KeptVector diagonal_;
  LinearPrior spare_;
};

}  // namespace stillpoint
