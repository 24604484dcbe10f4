// SPDX-License-Identifier: BSD-3-Clause
/// Normal equations over the states of a window (landmarks eliminated), and the terms of IMU, priors and zero
/// velocity.
#pragma once

#include <initializer_list>
#include <vector>

#include "core/backend/factors/reusable_matrix.h"
#include "core/backend/solvers/skyline_cholesky.h"
#include "core/backend/solvers/window_problem.h"

namespace stillpoint {

/// Column order of the variable states: velocities and biases, newest first (IMU factors couple only
/// neighbors, so these cause little fill-in); then poses, oldest first; then extrinsics, gravity, time
/// offset, depth scale and lens, if variable.
class ReducedLayout {
 public:
  ReducedLayout() = default;
  ReducedLayout(int frames, bool inertial, VariableGlobals variable)
      : frames_(frames), inertial_(inertial), variable_(variable) {}

  /// -1 for a constant block.
  [[nodiscard]] int column(BlockRef block) const {
    switch (block.kind) {
      case BlockKind::kPose:
        return first_pose() + 6 * block.frame;
      case BlockKind::kSpeedBias:
        return inertial_ ? 9 * (frames_ - 1 - block.frame) : -1;
      case BlockKind::kExtrinsics:
        return variable_.extrinsics ? first_global() : -1;
      case BlockKind::kGravity:
        return variable_.gravity ? first_gravity() : -1;
      case BlockKind::kDepthScale:
        return variable_.depth_scale ? first_depth_scale() : -1;
      case BlockKind::kLens:
        return variable_.lens ? first_lens() : -1;
      case BlockKind::kTimeOffset:
        break;
    }
    return variable_.time_offset ? first_time_offset() : -1;
  }
  [[nodiscard]] int first_pose() const { return inertial_ ? 9 * frames_ : 0; }
  /// Padded to a multiple of kTile.
  [[nodiscard]] int size() const { return first_global() + (globals() + kTile - 1) / kTile * kTile; }
  /// Number of rows at the end that belong to no state.
  [[nodiscard]] int padding() const { return size() - first_global() - globals(); }
  [[nodiscard]] int frames() const { return frames_; }
  [[nodiscard]] const VariableGlobals& variable_globals() const { return variable_; }

 private:
  [[nodiscard]] int globals() const { return first_lens() + (variable_.lens ? 4 : 0) - first_global(); }
  [[nodiscard]] int first_global() const { return first_pose() + 6 * frames_; }
  [[nodiscard]] int first_gravity() const { return first_global() + (variable_.extrinsics ? 6 : 0); }
  [[nodiscard]] int first_time_offset() const { return first_gravity() + (variable_.gravity ? 2 : 0); }
  [[nodiscard]] int first_depth_scale() const {
    return first_time_offset() + (variable_.time_offset ? 1 : 0);
  }
  [[nodiscard]] int first_lens() const { return first_depth_scale() + (variable_.depth_scale ? 1 : 0); }

  int frames_ = 0;
  bool inertial_ = false;
  VariableGlobals variable_;
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
