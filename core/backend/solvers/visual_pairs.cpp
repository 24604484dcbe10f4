// SPDX-License-Identifier: BSD-3-Clause
// What the observations of VisualTerms between the same two frames share: the relative pose, and the map of
// their sums to the states.
#include "core/backend/solvers/visual_terms.h"

namespace stillpoint {
namespace {

Pose pose_at(const double* x) { return Pose{Eigen::Quaterniond(x + 3), Eigen::Vector3d(x)}; }

}  // namespace

/// Computes what the relative poses of `blocks` share.
CameraOnBody VisualTerms::place_cameras(const ParameterBlocks& blocks) {
  const CameraOnBody camera(pose_at(blocks.extrinsics()));
  cameras_.clear();
  for (int frame = 0; frame < frames_; ++frame) {
    cameras_.emplace_back(pose_at(blocks.pose(static_cast<std::size_t>(frame))), camera);
  }
  return camera;
}

/// Computes the relative poses of all frame pairs that share landmarks at the current states.
void VisualTerms::update_relative_poses(const ParameterBlocks& blocks) {
  time_offset_ = *blocks.time_offset();
  depth_scale_ = *blocks.depth_scale();
  const CameraOnBody camera = place_cameras(blocks);
  for (std::size_t host = 0; host < cameras_.size(); ++host) {
    for (std::size_t frame = host + 1; frame < cameras_.size(); ++frame) {
      const std::size_t shared = pair(host, frame);
      if (pair_used_[shared] != 0) set_pose(cameras_[host], cameras_[frame], camera, relative_poses_[shared]);
    }
  }
}

/// Evaluates the derivatives of the relative poses, but not the poses, at `point`.
void VisualTerms::update_pose_jacobians(const ParameterBlocks& point, bool with_extrinsics) {
  const CameraOnBody camera = place_cameras(point);
  for (std::size_t host = 0; host < cameras_.size(); ++host) {
    for (std::size_t frame = host + 1; frame < cameras_.size(); ++frame) {
      const std::size_t shared = pair(host, frame);
      if (pair_used_[shared] == 0) continue;
      RelativePoseLinearization& relative = relative_poses_[shared];
      set_pose_jacobians(cameras_[host], cameras_[frame], camera, relative);
      if (with_extrinsics) set_extrinsics_jacobian(cameras_[host], cameras_[frame], camera, relative);
    }
  }
}

/// H_pl += M_ij^T w J_y^T J_l of one observation. @param column w [J_y r]^T J_l
void VisualTerms::add_coupling(const VisualLandmark& landmark, int frame, const Column8& column,
                               const ReducedLayout& layout) {
  const RelativePoseLinearization& to = relative_poses_[pair(landmark.host, frame)];
  const Eigen::Matrix<double, 6, 1> relative = column.head<6>();
  const Eigen::Index to_column = landmark.column;
  coupling_.block<6, 1>(6 * frame, to_column).noalias() = to.J_pose_j.transpose() * relative;
  coupling_.block<6, 1>(6 * landmark.host, to_column).noalias() += to.J_pose_i.transpose() * relative;
  if (layout.variable_globals().extrinsics) {
    const int extrinsics = layout.column({BlockKind::kExtrinsics}) - layout.first_pose();
    coupling_.block<6, 1>(extrinsics, to_column).noalias() += to.J_extrinsics.transpose() * relative;
  }
  if (layout.variable_globals().time_offset) {
    coupling_(layout.column({BlockKind::kTimeOffset}) - layout.first_pose(), to_column) += column[6];
  }
}

void VisualTerms::add_pair(int host, int frame, ReducedSystem& system) const {
  struct PoseBlock {
    int column;
    const Matrix6& map;
  };
  const RelativePoseLinearization& to = relative_poses_[pair(host, frame)];
  const PairSum& sum = sums_[pair(host, frame)];
  const PoseBlock pose_blocks[] = {{system.layout.column({BlockKind::kPose, host}), to.J_pose_i},
                                   {system.layout.column({BlockKind::kPose, frame}), to.J_pose_j},
                                   {system.layout.column({BlockKind::kExtrinsics}), to.J_extrinsics}};
  const int time = system.layout.column({BlockKind::kTimeOffset});
  const int scale = system.layout.column({BlockKind::kDepthScale});
  const Column8& scale_sum = scale_sums_[pair(host, frame)];
  for (const PoseBlock& a : pose_blocks) {
    if (a.column < 0) continue;
    const Matrix6 left = a.map.transpose() * sum.topLeftCorner<6, 6>();
    for (const PoseBlock& b : pose_blocks) {
      if (b.column < 0 || a.column < b.column) continue;
      system.H.block<6, 6>(a.column, b.column).noalias() += left * b.map;
    }
    system.g.segment<6>(a.column).noalias() += a.map.transpose() * sum.block<6, 1>(0, 7);
    if (time >= 0) system.H.block<1, 6>(time, a.column).noalias() += sum.block<1, 6>(6, 0) * a.map;
    if (scale >= 0) {
      system.H.block<1, 6>(scale, a.column).noalias() += scale_sum.head<6>().transpose() * a.map;
    }
  }
  if (scale >= 0) system.g[scale] += scale_sum[7];
  if (scale >= 0 && time >= 0) system.H(scale, time) += scale_sum[6];
  if (time < 0) return;
  system.H(time, time) += sum(6, 6);
  system.g[time] += sum(6, 7);
}

}  // namespace stillpoint
