// SPDX-License-Identifier: BSD-3-Clause
/// Marginalization: removes a frame from the window and keeps its information about the others as a prior.
#pragma once

#include <Eigen/QR>

#include "core/backend/solvers/window_problem.h"
#include "core/backend/window/window.h"
#include "core/config/backend_config.h"

namespace stillpoint {

/// Prior of the remaining states after marginalizing the oldest frame and the landmarks hosted in it.
///
/// All residuals that involve these variables (the current prior, the IMU factor to frame 1, the reprojection
/// residuals of the landmarks, the latter weighted by their robust loss) are linearized once at the current
/// estimate x0. With H = sum J_k^T J_k and b = sum J_k^T r_k, split into the marginalized states m (frame 0;
/// its landmarks are eliminated first, in the same way) and the remaining states r,
///
///   [ H_mm  H_mr ] [dx_m]     [ b_m ]
///   [ H_rm  H_rr ] [dx_r] = - [ b_r ],
///
/// minimizing over dx_m leaves the Schur complement
///
///   H* = H_rr - H_rm H_mm^-1 H_mr,    b* = b_r - H_rm H_mm^-1 b_m.
///
/// A square root J^T J = H*, J^T r0 = b* gives the residual of LinearPrior, r(x) = r0 + J (x [-] x0); x0 is
/// stored as the linearization point of its blocks. The square root is computed
///  - kCeres: from H* = V D V^T as J = D^1/2 V^T, r0 = D^-1/2 V^T b*, without the eigenvalues that are
///    numerically zero; H_mm^-1 is the corresponding pseudo-inverse;
///  - kSchur: from the Cholesky factor L of H in the order (m, r). Its lower right block is the factor of H*:
///    J = L_rr^T, and r0 is the lower part of L^-1 b. Small pivots fall back to the eigenvalues.
///
/// Qin et al. 2018, Sec. VI. Frame indices of the result are those after the slide (one less). The window
/// is not changed. The result is empty if no residual connects frame 0 to the others.
/// @param focal_px focal length of the camera
[[nodiscard]] LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config,
                                             double focal_px);

class SchurSolver;

/// Same, with the buffers of `solver`; the result does not depend on earlier calls.
[[nodiscard]] LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config,
                                             double focal_px, SchurSolver& solver);

/// Blocks that the new prior may involve: the states after the oldest frame. Calibration is treated as
/// constant, because linearizing at an early, inaccurate time offset would add overconfident information.
/// @param recycled storage for the result; its content is ignored
[[nodiscard]] std::vector<BlockRef> candidate_blocks(const Window& window,
                                                     std::vector<BlockRef> recycled = {});

/// Marginalizes one frame out of a prior. With J = [J_m J_r] and the QR decomposition J_m = Q R of rank k,
/// only the first k rows of Q^T r depend on the frame and can be made zero by its state; the other rows, of
/// Q^T J_r and Q^T r0, are the prior of the remaining states. The object is reused for its buffers only.
class FrameMarginalizer {
 public:
  /// Decrements the frame indices above `frame`.
  /// @param frame >= 0, that is, not calibration
  void remove(int frame, LinearPrior& prior);

 private:
  static constexpr int kMaxColumns = 15;  ///< pose, velocity and biases
  static constexpr int kMaxRows = kMaxColumns * (kMaxWindowSize + 1);
  /// Columns of the states of one frame; fixed capacity, so the factorization does not allocate.
  using FrameColumns =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxRows, kMaxColumns>;

  void split(int frame, const LinearPrior& prior);

  FrameColumns marginalized_columns_;
  ReusableMatrix<Eigen::MatrixXd> remaining_columns_;  ///< [J_r r0]
  Eigen::ColPivHouseholderQR<FrameColumns> qr_;
  LinearPrior result_;
};

}  // namespace stillpoint
