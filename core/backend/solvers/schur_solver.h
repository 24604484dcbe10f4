// SPDX-License-Identifier: BSD-3-Clause
/// State optimization specialized for the window's sparsity: Schur complement over the landmarks and Powell's
/// dogleg. Paper Sec. II (state optimization).
#pragma once

#include <span>
#include <vector>

#include "core/backend/solvers/visual_terms.h"
#include "core/backend/solvers/window_solver.h"

namespace stillpoint {

/// Specialized implementation of WindowSolver (tests compare its normal equations with those of Ceres).
///
/// The variables are the states p (velocities and biases, poses, calibration) and the inverse depths l. With
/// the Jacobian J of the residuals r, weighted by the robust loss, the Gauss-Newton equations H dx = -g with
/// H = J^T J, g = J^T r are
///
///   [ H_pp  H_pl ] [dp]     [ g_p ]
///   [ H_lp  H_ll ] [dl] = - [ g_l ].
///
/// No residual involves two landmarks, so H_ll is diagonal. Eliminating dl gives the reduced system
///
///   S dp = -g_p + H_pl H_ll^-1 g_l,    S = H_pp - H_pl H_ll^-1 H_lp    (Schur complement)
///
/// which is solved by skyline Cholesky; the landmarks follow by back-substitution:
///
///   dl = -H_ll^-1 (g_l + H_lp dp).
///
/// H_pp and H_ll are regularized by mu D with D = diag(H), bounded from below; mu starts at 1e-8 and is
/// increased tenfold while S is not positive definite.
///
/// The step is Powell's dogleg in the norm |dx|_D = sqrt(dx^T D dx): the Gauss-Newton step if it lies within
/// the trust region, otherwise the point where the path 0 -> Cauchy point -> Gauss-Newton step leaves it. The
/// Cauchy point is -a D^-1 g with a = g^T D^-1 g / (d^T H d), d = D^-1 g. The trust region is updated by the
/// ratio of the actual decrease of the cost to the predicted one, -g^T dx - 1/2 dx^T H dx.
class SchurSolver final : public WindowSolver {
 public:
  /// The square root of H* is taken from the Cholesky factor L of H in the order (m, r): its lower right
  /// block is the factor of H*, so J = L_rr^T, and r0 is the lower part of L^-1 b. Small pivots fall back to
  /// the eigenvalues, as in CeresSolver. Allocation-free in the steady state.
  [[nodiscard]] LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config,
                                               double focal_px, LinearPrior recycled) override;

  /// With S = L L^T, the rows and columns I of S^-1 are Y^T Y, where L Y = E_I and E_I are the columns I of
  /// the identity: one forward substitution, which starts late for poses and global states.
  [[nodiscard]] std::optional<WindowCovariance> covariance(const Window& window, const BackendConfig& config,
                                                           double focal_px, bool oldest_motion) override;

 private:
  [[nodiscard]] SolveReport minimize(Window& window, const BackendConfig& config, double focal_px) override;

  /// A vector (p, l) in the space of all states and variable landmarks.
  struct Direction {
    ReusableVector states;
    ReusableVector landmarks;
  };

  void read(const Window& window, const BackendConfig& config, double focal_px, VariableGlobals variable);
  [[nodiscard]] double linearize(const Window& window, const BackendConfig& config);
  [[nodiscard]] double cost_at(const Window& window, const ParameterBlocks& blocks);
  [[nodiscard]] bool compute_newton_step();
  void compute_dogleg_step(double radius);
  [[nodiscard]] double scaled_norm(const Direction& direction) const;
  [[nodiscard]] double curvature(const Direction& direction);
  [[nodiscard]] double predicted_decrease(const Direction& direction);
  void apply_step();
  [[nodiscard]] SolveReport iterate(const Window& window, const BackendConfig& config);
  void append_columns(BlockRef block);
  [[nodiscard]] NewestMatrix inverse_blocks(std::span<const BlockRef> blocks);
  [[nodiscard]] bool factorize_columns();
  [[nodiscard]] LinearPrior with_square_root(LinearPrior prior, Eigen::Index marginalized);

  ReducedLayout layout_;
  ReducedSystem system_;
  VisualTerms visual_;
  PriorTerm prior_;
  PriorTerm calibration_;
  ParameterBlocks blocks_;
  ParameterBlocks candidate_;
  ParameterBlocks point_;  ///< of the Jacobians, if not blocks_
  ReusableMatrix<RowMajorMatrix> S_;
  Direction scale_squared_;  // D
  Direction newton_;
  Direction cauchy_;
  Direction step_;
  ReusableVector coupling_product_;  // H_lp times a vector of states
  ReusableVector product_;           // H_pp times a vector of states
  std::vector<int> columns_;         // marginalization: marginalized columns, then remaining ones
  std::vector<int> dense_;           // skyline profile of a dense matrix
  std::vector<BlockRef> prior_blocks_;
  ReusableMatrix<ForwardColumns> unit_columns_;  // covariance: E_I, then L^-1 E_I
  ReusableVector diagonal_;
};

}  // namespace stillpoint
