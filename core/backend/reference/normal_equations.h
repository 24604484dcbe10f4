// SPDX-License-Identifier: BSD-3-Clause
/// Dense normal equations over all states of a window, from the residuals of Ceres.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/backend/reference/ceres_residuals.h"

namespace stillpoint {

/// Column order of all states of a window: poses, then velocities and biases, then global states.
class StateLayout {
 public:
  explicit StateLayout(int frames) : frames_(frames) {}
  [[nodiscard]] int size() const { return kFrameColumns * frames_ + kGlobalColumns; }
  [[nodiscard]] int column(BlockRef block) const {
    switch (block.kind) {
      case BlockKind::kPose:
        return 6 * block.frame;
      case BlockKind::kSpeedBias:
        return 6 * frames_ + 9 * block.frame;
      case BlockKind::kExtrinsics:
        return 15 * frames_;
      case BlockKind::kGravity:
        return 15 * frames_ + 7;
      case BlockKind::kDepthScale:
        return 15 * frames_ + 9;
      case BlockKind::kLens:
        return 15 * frames_ + 10;
      case BlockKind::kTimeOffset:
        break;
    }
    return 15 * frames_ + 6;
  }

 private:
  int frames_;
};

/// H dx = -b with H = sum J^T J, b = sum J^T r over linearized residuals. Unconstrained blocks have zero
/// rows.
struct NormalEquations {
  explicit NormalEquations(int frames);

  /// Adds the residuals of one landmark (or of none), linearized at `blocks`. Unless it is `fixed`, the
  /// inverse depth l of the landmark is eliminated: H -= H_xl H_xl^T / H_ll, b -= H_xl b_l / H_ll.
  /// @param information factor on the information of the residuals
  void add(const std::vector<Residual>& group, const ParameterBlocks& blocks, bool fixed,
           double information = 1.0);

  StateLayout layout;
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
};

/// The normal equations of all residuals of a window, linearized at `blocks`; landmarks are eliminated.
[[nodiscard]] NormalEquations linearize_all(const Window& window, const BackendConfig& config,
                                            double focal_px, const ParameterBlocks& blocks);

}  // namespace stillpoint
