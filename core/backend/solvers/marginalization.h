// SPDX-License-Identifier: BSD-3-Clause
/// Marginalization of variables out of linear equations: of one frame out of a prior, for a frame that leaves
/// the window without its observations, and by the Schur complement, with a square root of the result.
#pragma once

#include <Eigen/QR>

#include "core/backend/factors/linear_prior.h"
#include "core/config/backend_config.h"

namespace stillpoint {

/// Marginalizes one frame out of a prior. With J = [J_m J_r] and the QR decomposition J_m = Q R of rank k,
/// only the first k rows of Q^T r depend on the frame and can be made zero by its state; the other rows, of
/// Q^T J_r and Q^T r0, are the prior of the remaining states. The object is reused for its buffers only.
class FrameMarginalizer {
 public:
  /// The prior without the frame; the frame indices above `frame` are decremented.
  /// @param frame >= 0, that is, not a global state
  [[nodiscard]] LinearPrior remove(int frame, LinearPrior prior);

 private:
  static constexpr int kMaxRows = kFrameColumns * (kMaxWindowSize + 1) + kGlobalColumns;
  /// Columns of the states of one frame; fixed capacity, so the factorization does not allocate.
  using FrameColumns =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxRows, kFrameColumns>;

  void split(int frame, const LinearPrior& prior);

  FrameColumns marginalized_columns_;
  ReusableMatrix<Eigen::MatrixXd> remaining_columns_;  ///< [J_r r0]
  Eigen::ColPivHouseholderQR<FrameColumns> qr_;
  LinearPrior result_;  ///< buffers of the last but one prior
};

/// (J, r) with J^T J = H_rr - H_rm H_mm^-1 H_mr and J^T r = b_r - H_rm H_mm^-1 b_m, where m are the columns
/// `marginalized` and r the columns `remaining`. See
/// WindowSolver::marginalize_oldest.
struct SquareRoot {
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd residual;
};
[[nodiscard]] SquareRoot eliminate(const Eigen::MatrixXd& H, const Eigen::VectorXd& b,
                                   const std::vector<int>& marginalized, const std::vector<int>& remaining);

}  // namespace stillpoint
