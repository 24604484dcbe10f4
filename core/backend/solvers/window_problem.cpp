// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/window_problem.h"

#include <algorithm>
#include <utility>

#include "core/backend/window/landmark_tracks.h"

namespace stillpoint {
namespace {

/// Of a track that continues, see marginalized_fraction.
constexpr double kMarginalizedFraction = 0.2;

/// Published prior: below this speed the image motion is too small to observe time offset and extrinsics.
constexpr double kMinSpeedForCalibration = 0.2;  // [m/s]

void pack_pose(const Pose& pose, double* values) {
  Eigen::Map<Eigen::Vector3d>{values} = pose.p;
  Eigen::Map<Eigen::Vector4d>{values + 3} = pose.q.coeffs();
}

Pose unpack_pose(const double* values) {
  return Pose{Eigen::Quaterniond(values + 3).normalized(), Eigen::Vector3d(values)};
}

}  // namespace

void ParameterBlocks::assign(const Window& window) {
  frames_ = window.frames.size();
  values_.resize(first_landmark() + window.landmarks.size());
  for (int frame = 0; frame <= window.newest(); ++frame) {
    const NavState& state = window.frames[static_cast<std::size_t>(frame)].state;
    pack_pose(state.T_w_b, at({BlockKind::kPose, frame}));
    Eigen::Map<Eigen::Matrix<double, 9, 1>>{at({BlockKind::kSpeedBias, frame})} << state.v_w, state.gyro_bias,
        state.accel_bias;
  }
  pack_pose(window.T_b_c, at({BlockKind::kExtrinsics}));
  *at({BlockKind::kTimeOffset}) = window.time_offset_s;
  *at({BlockKind::kDepthScale}) = 1.0 / window.depth_scale;
  Eigen::Map<Eigen::Vector4d>{at({BlockKind::kLens})} = window.lens;
  Eigen::Map<Eigen::Vector3d>{at({BlockKind::kGravity})} = window.gravity_w;
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    *inverse_depth(i) = window.landmarks[i].inverse_depth;
  }
}

std::size_t ParameterBlocks::offset(BlockRef block) const {
  switch (block.kind) {
    case BlockKind::kPose:
      return 7 * static_cast<std::size_t>(block.frame);
    case BlockKind::kSpeedBias:
      return 7 * frames_ + 9 * static_cast<std::size_t>(block.frame);
    case BlockKind::kExtrinsics:
      return 16 * frames_;
    case BlockKind::kGravity:
      return 16 * frames_ + 8;
    case BlockKind::kDepthScale:
      return 16 * frames_ + 11;
    case BlockKind::kLens:
      return 16 * frames_ + 12;
    case BlockKind::kTimeOffset:
      break;
  }
  return 16 * frames_ + 7;
}

namespace {

bool is_calibration_of_images(BlockKind kind) {
  return kind == BlockKind::kTimeOffset || kind == BlockKind::kDepthScale || kind == BlockKind::kLens;
}

}  // namespace

Linearization linearize_at(const ParameterBlocks& now, const Window& window, const BackendConfig& config,
                           ParameterBlocks& point) {
  if (config.prior != PriorModel::kConsistent) return {now, now};
  point = now;
  for (const PriorBlock& block : window.prior.blocks) {
    if (is_calibration_of_images(block.kind)) continue;
    std::copy_n(block.linearization.data(), global_size(block.kind), point.at({block.kind, block.frame}));
  }
  return {now, point};
}

void unpack(const ParameterBlocks& blocks, Window& window) {
  for (int frame = 0; frame <= window.newest(); ++frame) {
    NavState& state = window.frames[static_cast<std::size_t>(frame)].state;
    state.T_w_b = unpack_pose(blocks.at({BlockKind::kPose, frame}));
    const double* values = blocks.at({BlockKind::kSpeedBias, frame});
    state.v_w = Eigen::Vector3d(values);
    state.gyro_bias = Eigen::Vector3d(values + 3);
    state.accel_bias = Eigen::Vector3d(values + 6);
  }
  window.T_b_c = unpack_pose(blocks.at({BlockKind::kExtrinsics}));
  window.time_offset_s = *blocks.at({BlockKind::kTimeOffset});
  window.depth_scale = 1.0 / *blocks.at({BlockKind::kDepthScale});
  set_lens(Eigen::Vector4d(blocks.at({BlockKind::kLens})), window);
  window.gravity_w = Eigen::Vector3d(blocks.at({BlockKind::kGravity}));
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    window.landmarks[i].inverse_depth = *blocks.inverse_depth(i);
  }
}

ReprojectionNoise reprojection_noise(const BackendConfig& config, double focal_px) {
  return {.bearing = config.pixel_sigma_px / focal_px,
          .inverse_depth = config.depth.inverse_sigma,
          .depth_outlier = config.depth.outlier_sigmas};
}

bool has_constant_depth(const Landmark& landmark, const BackendConfig& config) {
  return config.depth.usage == DepthUsage::kFixed && landmark.source == DepthSource::kMeasured;
}

bool uses_depth(const Observation& observation, const BackendConfig& config) {
  return config.depth.usage == DepthUsage::kWeighted && observation.depth > 0.0;
}

bool VariableGlobals::has(BlockKind kind) const {
  switch (kind) {
    case BlockKind::kExtrinsics:
      return extrinsics;
    case BlockKind::kTimeOffset:
      return time_offset;
    case BlockKind::kGravity:
      return gravity;
    case BlockKind::kDepthScale:
      return depth_scale;
    case BlockKind::kLens:
      return lens;
    case BlockKind::kPose:
    case BlockKind::kSpeedBias:
      break;
  }
  return false;
}

std::vector<BlockRef> with_globals(std::vector<BlockRef> blocks, VariableGlobals variable) {
  for (const BlockKind kind : kGlobalKinds) {
    if (variable.has(kind)) blocks.push_back({kind});
  }
  return blocks;
}

VariableGlobals variable_globals(const Window& window, const BackendConfig& config) {
  const bool moving = window.inertial && (config.prior == PriorModel::kConsistent ||
                                          window.frames.back().state.v_w.norm() > kMinSpeedForCalibration);
  return {.extrinsics = estimates_extrinsics(window, config) && moving,
          .time_offset = config.estimate_time_offset && moving,
          .gravity = window.estimates_gravity(),
          .depth_scale = config.depth.estimate_scale && window.inertial,
          .lens = config.estimate_lens && window.inertial};
}

VariableGlobals solved_globals(const Window& window, const BackendConfig& config) {
  VariableGlobals globals = variable_globals(window, config);
  if (window.agrees_with_rig.extrinsics) globals.extrinsics = false;
  if (window.agrees_with_rig.depth_scale) globals.depth_scale = false;
  if (window.agrees_with_rig.lens) globals.lens = false;
  return globals;
}

VariableGlobals marginalized_globals(const Window& window, const BackendConfig& config) {
  VariableGlobals globals = variable_globals(window, config);
  if (config.prior != PriorModel::kConsistent) globals.extrinsics = globals.time_offset = false;
  return globals;
}

double marginalized_fraction(const Landmark& landmark, const Window& window, const BackendConfig& config) {
  const bool continues = landmark.last() == window.newest();
  return continues && config.prior == PriorModel::kConsistent ? kMarginalizedFraction : 1.0;
}

void remove_marginalized_information(const BackendConfig& config, Window& window) {
  if (config.prior != PriorModel::kConsistent) return;
  for (Landmark& landmark : window.landmarks) {
    if (landmark.host != 0 || !is_usable(landmark)) continue;
    const double remaining = 1.0 - marginalized_fraction(landmark, window, config);
    if (remaining <= 0.0) landmark.observations.resize(1);
    for (Observation& observation : landmark.observations) observation.information *= remaining;
  }
}

std::vector<BlockRef> candidate_blocks(const Window& window, const BackendConfig& config,
                                       std::vector<BlockRef> recycled) {
  std::vector<BlockRef> blocks = std::move(recycled);
  blocks.clear();
  for (int frame = 1; frame <= window.newest(); ++frame) blocks.push_back({BlockKind::kPose, frame});
  if (!window.inertial) return blocks;
  for (int frame = 1; frame <= window.newest(); ++frame) blocks.push_back({BlockKind::kSpeedBias, frame});
  return with_globals(std::move(blocks), marginalized_globals(window, config));
}

PriorBlock prior_block_after_slide(BlockRef block, const ParameterBlocks& point) {
  return {block.kind, std::max(block.frame - 1, -1),
          Eigen::Map<const BlockVector>(point.at(block), global_size(block.kind))};
}

void move_residual_to_linearization(const ParameterBlocks& now, LinearPrior& prior) {
  int column = 0;
  for (const PriorBlock& block : prior.blocks) {
    const int size = local_size(block.kind);
    const BlockRef before{block.kind, block.frame < 0 ? -1 : block.frame + 1};
    const BlockVector difference = block_difference(block.kind, now.at(before), block.linearization);
    if (!difference.isZero(0.0)) {
      prior.residual.noalias() -= prior.jacobian.middleCols(column, size) * difference;
    }
    column += size;
  }
}

}  // namespace stillpoint
