// SPDX-License-Identifier: BSD-3-Clause
/// Normal equations over the states of a window (landmarks eliminated), and the terms of IMU and priors.
#pragma once

#include <array>
#include <vector>

#include "core/backend/factors/reusable_matrix.h"
#include "core/backend/solvers/skyline_cholesky.h"
#include "core/backend/solvers/window_problem.h"

namespace stillpoint {

/// Column order of the variable states: velocities and biases, newest first (IMU factors couple only
/// neighbors, so these cause little fill-in); then poses, oldest first; then the variable global states.
class ReducedLayout {
 public:
  ReducedLayout() = default;
  ReducedLayout(int frames, bool inertial, VariableGlobals variable)
      : frames_(frames), inertial_(inertial), variable_(variable) {
    int end = first_pose() + 6 * frames;
    global_columns_.fill(-1);
    for (const BlockKind kind : kGlobalKinds) {
      if (!variable.has(kind)) continue;
      global_columns_[static_cast<std::size_t>(kind)] = end;
      end += local_size(kind);
    }
    size_ = (end + kTile - 1) / kTile * kTile;
    padding_ = size_ - end;
  }

  /// -1 for a constant block.
  [[nodiscard]] int column(BlockRef block) const {
    if (block.kind == BlockKind::kPose) return first_pose() + 6 * block.frame;
    if (block.kind == BlockKind::kSpeedBias) return inertial_ ? 9 * (frames_ - 1 - block.frame) : -1;
    return global_columns_[static_cast<std::size_t>(block.kind)];
  }
  [[nodiscard]] int first_pose() const { return inertial_ ? 9 * frames_ : 0; }
  /// Padded to a multiple of kTile.
  [[nodiscard]] int size() const { return size_; }
  /// Number of rows at the end that belong to no state.
  [[nodiscard]] int padding() const { return padding_; }
  [[nodiscard]] int frames() const { return frames_; }
  [[nodiscard]] const VariableGlobals& variable_globals() const { return variable_; }

 private:
  int frames_ = 0;
  bool inertial_ = false;
  VariableGlobals variable_;
  std::array<int, 7> global_columns_{};  ///< by BlockKind
  int size_ = 0;
  int padding_ = 0;
};

/// H dx = -g with H = J^T J, g = J^T r; only the lower triangle of H is stored. Unconstrained columns are
/// zero.
class ReducedSystem {
 public:
  /// Sets the system to zero; allocates only if it is larger than all systems before.
  void reset(const ReducedLayout& layout);

  /// Extends the skyline profile for a residual that involves these blocks.
  void widen_profile(std::span<const BlockRef> blocks);

  /// Adds to the block at (row, column) of H; ignores constant blocks (-1) and blocks above the diagonal.
  template <class Block>
  void add(int row, int column, const Block& block) {
    if (row < 0 || column < 0 || row < column) return;
    H.block(row, column, block.rows(), block.cols()) += block;
  }

  /// Copies the part of H within the profile.
  void copy_profile_to(ReusableMatrix<RowMajorMatrix>& S) const;

  ReducedLayout layout;
  ReusableMatrix<RowMajorMatrix> H;
  ReusableVector g;
  std::vector<int> first;  ///< profile of H, for `skyline_factorize`
};

/// Whether there is an IMU factor between frame - 1 and frame.
[[nodiscard]] bool has_imu_term(const Window& window, int frame);
/// Cost of the IMU factor between frame - 1 and frame; requires `has_imu_term`.
[[nodiscard]] double imu_cost(const Window& window, int frame, const ParameterBlocks& blocks);
/// Adds J^T J and J^T r of that factor. @return the cost
double add_imu_term(const Window& window, int frame, const Linearization& at, ReducedSystem& system);

/// A LinearPrior (of marginalization or calibration) as a term of the system; its Jacobian is constant.
class PriorTerm {
 public:
  /// @param prior outlives the term
  void read(const LinearPrior& prior);
  [[nodiscard]] std::span<const BlockRef> blocks() const { return blocks_; }
  [[nodiscard]] double cost(const ParameterBlocks& blocks);
  /// @return the cost
  double add_to(ReducedSystem& system, const ParameterBlocks& blocks);

 private:
  const LinearPrior* prior_ = nullptr;
  std::vector<BlockRef> blocks_;
  ReusableMatrix<Eigen::MatrixXd>
      jacobian_;  // of information_: solve, covariance and marginalization share it
  ReusableMatrix<Eigen::MatrixXd> information_;  // J^T J, lower triangle
  ReusableVector difference_;
  ReusableVector error_;
  ReusableVector gradient_;
};

}  // namespace stillpoint
