// SPDX-License-Identifier: BSD-3-Clause
/// Normal equations over the states of a window, once its landmarks are eliminated, and what fills them
/// besides landmarks.
#pragma once

#include <initializer_list>
#include <vector>

#include "core/backend/kept_matrix.h"
#include "core/backend/schur/skyline_cholesky.h"
#include "core/backend/window_problem.h"

namespace stillpoint {

/// Columns of the states that move: speeds and biases, newest first, because inertial data couple only
/// neighbours and so fill in little; then poses, oldest first; then calibration, where it is free.
class ReducedLayout {
 public:
  ReducedLayout() = default;
  ReducedLayout(int frames, bool inertial, FreeCalibration free)
      : frames_(frames), inertial_(inertial), free_(free) {}

  /// -1 for a block that is held.
  [[nodiscard]] int column(BlockRef block) const;
  [[nodiscard]] int first_pose() const { return inertial_ ? 9 * frames_ : 0; }
  /// Filled up to a multiple of kTile.
  [[nodiscard]] int size() const {
    return first_pose() + 6 * frames_ + (free_.extrinsics ? 6 : 0) + (free_.time_offset ? kTile : 0);
  }
  [[nodiscard]] int frames() const { return frames_; }
  [[nodiscard]] FreeCalibration free() const { return free_; }

 private:
  int frames_ = 0;
  bool inertial_ = false;
  FreeCalibration free_;
};

/// H x = -g; only the lower triangle of H is kept. Columns that nothing touched are zero.
class ReducedSystem {
 public:
  /// An empty system; no allocation once one as large has been held.
  void reset(const ReducedLayout& layout);

  /// Says that a residual reads these blocks together: widens the rows of the profile.
  void couple(std::span<const BlockRef> blocks);

  /// Adds a block at two states' columns, and nothing above the diagonal. Held ones are passed over.
  template <class Block>
  void add(int row, int column, const Block& block) {
    if (row < 0 || column < 0 || row < column) return;
    H.block(row, column, block.rows(), block.cols()) += block;
  }

  ReducedLayout layout;
  KeptMatrix<RowMajorMatrix> H;
  KeptVector g;
  std::vector<int> first;  ///< profile of H, for `skyline_factorize`
};

/// Whether inertial data tie a frame to the one before.
[[nodiscard]] bool has_imu_term(const Window& window, int frame);
/// Cost of what the IMU measured between frame - 1 and frame, where `has_imu_term`.
[[nodiscard]] double imu_cost(const Window& window, int frame, ParameterBlocks& blocks);
/// @return the cost
double add_imu_term(const Window& window, int frame, ParameterBlocks& blocks, ReducedSystem& system);

/// What gone frames, or the rig, said: a residual whose Jacobian never changes.
class PriorTerm {
 public:
  /// @param prior outlives the term
  void read(const LinearPrior& prior);
  [[nodiscard]] std::span<const BlockRef> blocks() const { return blocks_; }
  [[nodiscard]] double cost(ParameterBlocks& blocks);
  /// @return the cost
  double add_to(ReducedSystem& system, ParameterBlocks& blocks);

 private:
  const LinearPrior* prior_ = nullptr;
  std::vector<BlockRef> blocks_;
  KeptMatrix<Eigen::MatrixXd> information_;  // J^T J, lower triangle
  KeptVector difference_;
  KeptVector error_;
  KeptVector gradient_;
};

}  // namespace stillpoint
