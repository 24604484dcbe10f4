// SPDX-License-Identifier: BSD-3-Clause
/// Linear prior on the window's states, as left by marginalization: a linearized residual.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/backend/factors/reusable_matrix.h"

namespace stillpoint {

/// The first two belong to a frame, the others to the window (global states). The value of kDepthScale is the
/// inverse depth scale, that of kLens the lens correction, see reprojection_rows.h.
enum class BlockKind { kPose, kSpeedBias, kExtrinsics, kTimeOffset, kGravity, kDepthScale, kLens };

/// The global states, in the order of their columns in the reduced equations.
inline constexpr std::array kGlobalKinds = {BlockKind::kExtrinsics, BlockKind::kGravity,
                                            BlockKind::kTimeOffset, BlockKind::kDepthScale, BlockKind::kLens};

/// Number of doubles in a parameter block, and of its tangent space.
[[nodiscard]] constexpr int global_size(BlockKind kind) {
  constexpr int kSizes[] = {7, 9, 7, 1, 3, 1, 4};
  return kSizes[static_cast<std::size_t>(kind)];
}
[[nodiscard]] constexpr int local_size(BlockKind kind) {
  constexpr int kSizes[] = {6, 9, 6, 1, 2, 1, 4};
  return kSizes[static_cast<std::size_t>(kind)];
}

/// Columns of pose, velocity and biases of one frame, and of all global states.
inline constexpr int kFrameColumns = 15;
inline constexpr int kGlobalColumns = 14;

/// Values of one block, or its tangent vector: at most nine, stored inline.
using BlockVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 9, 1>;

/// One parameter block of the prior and its linearization point x0.
struct PriorBlock {
  BlockKind kind = BlockKind::kPose;
  int frame = -1;             ///< index in the window; -1 for global states
  BlockVector linearization;  ///< `global_size(kind)` values
};

/// Cost 1/2 |r(x)|^2 with the linearized residual
///
///   r(x) = r0 + J (x [-] x0)
///
/// where x stacks the states in the order of `blocks`, x0 is their linearization point, J = `jacobian` and r0
/// = `residual`. J and r0 are computed once, at x0, and never relinearized (first-estimates Jacobian): only
/// the difference x [-] x0 follows the states. The normal equations of the prior at x are J^T J dx = -J^T
/// r(x). See WindowSolver::marginalize_oldest
/// for how J and r0 are obtained.
struct LinearPrior {
  std::vector<PriorBlock> blocks;
  ReusableMatrix<Eigen::MatrixXd> jacobian;
  ReusableVector residual;

  [[nodiscard]] bool empty() const { return blocks.empty(); }
};

/// x <- x [+] d with a tangent vector d: for poses (p + dp, q Exp(dtheta)); for gravity `rotate_gravity`; for
/// other blocks x + d.
void displace_block(BlockKind kind, const double* d, double* x);

/// x [-] origin, in the tangent space at `origin`, the inverse of [+]: for poses (p - p0, Log(q0^-1 q)); for
/// gravity `gravity_difference`; for other blocks x - x0.
[[nodiscard]] BlockVector block_difference(BlockKind kind, const double* x, const BlockVector& origin);

/// Adds independent random steps to the components of a global state: with x' = x + w, w ~ N(0, S), the
/// residual at x' has the covariance I + J_x S J_x^T, by which it is whitened again; component by component,
/// with u = J_x, s the standard deviation,
///
///   J <- W J,  r0 <- W r0,    W = I - (1 - 1 / sqrt(1 + s^2 |u|^2)) u u^T / |u|^2.
///
/// A prior without the block is unchanged.
/// @param sigmas of the steps, one per component, >= 0
void add_random_step(BlockKind kind, std::span<const double> sigmas, LinearPrior& prior);

/// Covariance of gravity by the prior alone, in the tangent space at its linearization point [rad^2]; nothing
/// if the prior does not constrain gravity or is not finite.
[[nodiscard]] std::optional<Eigen::Matrix2d> gravity_covariance(const LinearPrior& prior);

}  // namespace stillpoint
