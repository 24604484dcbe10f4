// SPDX-License-Identifier: BSD-3-Clause
/// Dense normal equations over the window's states, and their way to a prior by Schur complement and square
/// root.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/backend/window_problem.h"

namespace stillpoint {

/// Columns of all states of a window: poses, then speeds and biases, then calibration.
class StateLayout {
 public:
  explicit StateLayout(int frames) : frames_(frames) {}
  [[nodiscard]] int size() const { return 15 * frames_ + 7; }
  [[nodiscard]] int column(BlockRef block) const {
    switch (block.kind) {
      case BlockKind::kPose:
        return 6 * block.frame;
      case BlockKind::kSpeedBias:
        return 6 * frames_ + 9 * block.frame;
      case BlockKind::kExtrinsics:
        return 15 * frames_;
      case BlockKind::kTimeOffset:
        break;
    }
    return 15 * frames_ + 6;
  }

 private:
  int frames_;
};

/// H x = -b summed over linearised residuals. Blocks that no residual touched have zero rows.
struct NormalEquations {
  explicit NormalEquations(int frames);

  /// Adds the residuals of one landmark (or of none) at the states in `blocks`; the landmark's inverse depth
  /// is eliminated on the spot unless it is `fixed`.
  void add(const std::vector<Residual>& group, ParameterBlocks& blocks, bool fixed);

  StateLayout layout;
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
};

/// The states that stay, as (J, r) with J^T J and J^T r equal to what is left of H and b once `gone` is
/// eliminated.
struct SquareRoot {
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd residual;
};
[[nodiscard]] SquareRoot eliminate(const Eigen::MatrixXd& H, const Eigen::VectorXd& b,
                                   const std::vector<int>& gone, const std::vector<int>& kept);

}  // namespace stillpoint
