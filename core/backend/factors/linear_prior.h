// SPDX-License-Identifier: BSD-3-Clause
/// What is known of the window's states from frames that have left it: a linearised residual.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/backend/kept_matrix.h"

namespace stillpoint {

enum class BlockKind { kPose, kSpeedBias, kExtrinsics, kTimeOffset };

/// Number of doubles in a parameter block, and of its tangent space.
[[nodiscard]] constexpr int global_size(BlockKind kind) {
  return kind == BlockKind::kSpeedBias ? 9 : kind == BlockKind::kTimeOffset ? 1 : 7;
}
[[nodiscard]] constexpr int local_size(BlockKind kind) {
  return kind == BlockKind::kSpeedBias ? 9 : kind == BlockKind::kTimeOffset ? 1 : 6;
}

/// Values of one block, or its tangent vector: at most nine, held in place.
using BlockVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 9, 1>;

/// One state that the prior speaks of, and where it was linearised.
struct PriorBlock {
  BlockKind kind = BlockKind::kPose;
  int frame = -1;             ///< index in the window; -1 for calibration
  BlockVector linearization;  ///< `global_size(kind)` values
};

/// residual(x) = residual + jacobian * (x [-] linearization), blocks side by side in the order of `blocks`.
struct LinearPrior {
  std::vector<PriorBlock> blocks;
  KeptMatrix<Eigen::MatrixXd> jacobian;
  KeptVector residual;

  [[nodiscard]] bool empty() const { return blocks.empty(); }
};

/// x [-] origin in the tangent space at origin; poses as (p, q xyzw) with the rotation on the right.
[[nodiscard]] BlockVector block_difference(BlockKind kind, const double* x, const BlockVector& origin);

}  // namespace stillpoint
