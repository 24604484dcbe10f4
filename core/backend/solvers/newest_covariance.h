// SPDX-License-Identifier: BSD-3-Clause
/// The blocks whose covariance is reported with each frame, and their place in WindowCovariance.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/backend/solvers/window_problem.h"
#include "core/backend/solvers/window_solver.h"
#include "core/geometry/covariance.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// At most 25 rows: pose, velocity and biases, gravity, extrinsics, time offset, depth scale.
using NewestMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 25, 25>;

/// Pose of the newest frame, its velocity and biases if there are any, and the variable global states.
/// @param recycled storage for the result; its content is ignored
[[nodiscard]] std::vector<BlockRef> newest_blocks(const Window& window, const BackendConfig& config,
                                                  std::vector<BlockRef> recycled = {});

/// @param covariance joint covariance of `blocks`, as `newest_blocks` gives them, in their order
[[nodiscard]] StateCovariance state_covariance(std::span<const BlockRef> blocks,
                                               const NewestMatrix& covariance);

/// At most as many rows as NewestMatrix.
using NewestVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 25, 1>;

/// @param blocks, covariance as in `state_covariance`
/// @param step Gauss-Newton step of the blocks, if all of them were variable
[[nodiscard]] RigContradiction rig_contradiction(const AgreesWithRig& constant,
                                                 std::span<const BlockRef> blocks,
                                                 const NewestMatrix& covariance, const NewestVector& step);

inline constexpr std::array<BlockRef, 2> kOldestPoses = {BlockRef{BlockKind::kPose, 0},
                                                         BlockRef{BlockKind::kPose, 1}};

/// T_b0_b1. @param covariance joint covariance of `kOldestPoses`
[[nodiscard]] UncertainPose oldest_motion_of(const Window& window, const NewestMatrix& covariance);

}  // namespace stillpoint
