// SPDX-License-Identifier: BSD-3-Clause
/// Takes a frame out of the window and keeps what it said about the others as a prior.
#pragma once

#include <Eigen/QR>

#include "core/backend/backend_config.h"
#include "core/backend/window.h"
#include "core/backend/window_problem.h"

namespace stillpoint {

/// The prior once the oldest frame and the landmarks it hosts are gone. Frame indices are already those after
/// the slide (each one less). The window itself is not changed. Empty where nothing ties that frame to the
/// others.
/// @param focal_px the camera's focal length
[[nodiscard]] LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config,
                                             double focal_px);

class SchurSolver;

/// The same in memory kept from the last call; the result does not depend on it.
[[nodiscard]] LinearPrior marginalize_oldest(const Window& window, const BackendConfig& config,
                                             double focal_px, SchurSolver& solver);

/// All blocks that a prior without the oldest frame may speak of: the states after it. Calibration is taken
/// as known: an early, wrong time offset would be frozen into the prior, sure of itself.
/// @param memory for the result: a list that nobody needs any more
[[nodiscard]] std::vector<BlockRef> candidate_blocks(const Window& window, std::vector<BlockRef> memory = {});

/// Takes what a prior says on one frame out of it; kept from frame to frame for its memory only.
class FrameMarginalizer {
 public:
  /// Indices above `frame` become one less.
  /// @param frame not calibration
  void remove(int frame, LinearPrior& prior);

 private:
  static constexpr int kMaxColumns = 15;  ///< pose, speed and biases
  static constexpr int kMaxRows = kMaxColumns * (kMaxWindowSize + 1);
  /// Columns of the states of one frame: small enough for Eigen to hold the factorisation in place.
  using FrameColumns =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxRows, kMaxColumns>;

  void split(int frame, const LinearPrior& prior);

  FrameColumns gone_;
  KeptMatrix<Eigen::MatrixXd> rest_;  ///< the other columns, and the residual behind them
  Eigen::ColPivHouseholderQR<FrameColumns> qr_;
  LinearPrior left_;
};

}  // namespace stillpoint
