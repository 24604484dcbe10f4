// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/window_solver.h"

#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "core/base/error.h"

namespace stillpoint {
namespace {

/// Resets landmarks at infinity or behind their host, so that their depth is initialized again.
void invalidate_lost_depths(const DepthConfig& config, Window& window) {
  for (Landmark& landmark : window.landmarks) {
    if (landmark.inverse_depth * config.max_landmark_depth_m < 1.0) landmark.inverse_depth = 0.0;
  }
}

}  // namespace

SolveReport WindowSolver::solve(Window& window, const BackendConfig& config, double focal_px) {
  STILLPOINT_CHECK(!window.prior.empty());
  const SolveReport report = minimize(window, config, focal_px);
  if (report.usable) invalidate_lost_depths(config.depth, window);
  return report;
}

std::vector<BlockRef> newest_blocks(const Window& window, const BackendConfig& config,
                                    std::vector<BlockRef> recycled) {
  std::vector<BlockRef> blocks = std::move(recycled);
  blocks.clear();
  blocks.push_back({BlockKind::kPose, window.newest()});
  if (window.inertial) blocks.push_back({BlockKind::kSpeedBias, window.newest()});
  return with_globals(std::move(blocks), variable_globals(window, config));
}

StateCovariance state_covariance(std::span<const BlockRef> blocks, const NewestMatrix& covariance) {
  StateCovariance result;
  int column = 0;
  for (const BlockRef block : blocks) {
    switch (block.kind) {
      case BlockKind::kPose:
        result.state.topLeftCorner<6, 6>() = covariance.block<6, 6>(column, column);
        break;
      case BlockKind::kSpeedBias:  // follows the pose
        result.state = covariance.topLeftCorner<15, 15>();
        result.inertial = true;
        break;
      case BlockKind::kGravity:
        result.gravity = covariance.block<2, 2>(column, column);
        break;
      case BlockKind::kExtrinsics:
        result.extrinsics = covariance.block<6, 6>(column, column);
        break;
      case BlockKind::kTimeOffset:
        result.time_offset = covariance(column, column);
        break;
      case BlockKind::kDepthScale:
        result.depth_scale = covariance(column, column);
        break;
      case BlockKind::kLens:
        result.lens = covariance.block<4, 4>(column, column);
        break;
    }
    column += local_size(block.kind);
  }
  return result;
}

RigStep rig_step(std::span<const BlockRef> blocks, const NewestVector& step) {
  RigStep result;
  int column = 0;
  for (const BlockRef block : blocks) {
    if (block.kind == BlockKind::kExtrinsics) result.extrinsics = step.segment<6>(column);
    if (block.kind == BlockKind::kDepthScale) result.depth_scale = step[column];
    if (block.kind == BlockKind::kLens) result.lens = step.segment<4>(column);
    column += local_size(block.kind);
  }
  return result;
}

UncertainPose oldest_motion_of(const Window& window, const NewestMatrix& covariance) {
  return relative_pose(window.frames[0].state.T_w_b, window.frames[1].state.T_w_b, Matrix12(covariance));
}

}  // namespace stillpoint
