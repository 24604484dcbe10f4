// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/window_problem.h"

#include "core/backend/factors/imu_factor.h"
#include "core/backend/factors/prior_factor.h"
#include "core/backend/factors/reprojection_factor.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

void pack_pose(const Pose& pose, double* values) {
  Eigen::Map<Eigen::Vector3d>{values} = pose.p;
  Eigen::Map<Eigen::Vector4d>{values + 3} = pose.q.coeffs();
}

Pose unpack_pose(const double* values) {
  return Pose{Eigen::Quaterniond(values + 3).normalized(), Eigen::Vector3d(values)};
}

Residual prior_residual(const LinearPrior& prior) {
  Residual residual{std::make_unique<PriorFactor>(prior), nullptr, {}, -1};
  for (const PriorBlock& block : prior.blocks) residual.states.push_back({block.kind, block.frame});
  return residual;
}

}  // namespace

ParameterBlocks pack(const Window& window) {
  ParameterBlocks blocks(window.frames.size(), window.landmarks.size());
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    const NavState& state = window.frames[i].state;
    pack_pose(state.T_w_b, blocks.pose(i));
    Eigen::Map<Eigen::Matrix<double, 9, 1>>{blocks.speed_bias(i)} << state.v_w, state.gyro_bias,
        state.accel_bias;
  }
  pack_pose(window.T_b_c, blocks.extrinsics());
  *blocks.time_offset() = window.time_offset_s;
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    *blocks.inverse_depth(i) = window.landmarks[i].inverse_depth;
  }
  return blocks;
}

void unpack(ParameterBlocks& blocks, Window& window) {
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    NavState& state = window.frames[i].state;
    state.T_w_b = unpack_pose(blocks.pose(i));
    const double* values = blocks.speed_bias(i);
    state.v_w = Eigen::Vector3d(values);
    state.gyro_bias = Eigen::Vector3d(values + 3);
    state.accel_bias = Eigen::Vector3d(values + 6);
  }
  window.T_b_c = unpack_pose(blocks.extrinsics());
  window.time_offset_s = *blocks.time_offset();
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    window.landmarks[i].inverse_depth = *blocks.inverse_depth(i);
  }
}

double* block_address(ParameterBlocks& blocks, BlockRef block) {
  switch (block.kind) {
    case BlockKind::kPose:
      return blocks.pose(static_cast<std::size_t>(block.frame));
    case BlockKind::kSpeedBias:
      return blocks.speed_bias(static_cast<std::size_t>(block.frame));
    case BlockKind::kExtrinsics:
      return blocks.extrinsics();
    case BlockKind::kTimeOffset:
      break;
  }
  return blocks.time_offset();
}

std::vector<double*> parameter_addresses(const Residual& residual, ParameterBlocks& blocks) {
  std::vector<double*> addresses;
  for (const BlockRef state : residual.states) addresses.push_back(block_address(blocks, state));
  if (residual.landmark >= 0)
    addresses.push_back(blocks.inverse_depth(static_cast<std::size_t>(residual.landmark)));
  return addresses;
}

ResidualBuilder::ResidualBuilder(const Window& window, const BackendConfig& config, double focal_px)
    : window_(window),
      config_(config),
      bearing_sigma_(config.pixel_sigma_px / focal_px),
      loss_(std::make_unique<ceres::CauchyLoss>(config.cauchy_scale)) {}

/// With an IMU the bearing's velocity follows from the state: differences of tracked bearings share their
/// noise with the residual and pull the time offset.
Eigen::Vector2d ResidualBuilder::bearing_velocity(const Landmark& landmark, int frame) const {
  const Observation& observation = landmark.in(frame);
  if (!window_.inertial) return observation.velocity;

  const WindowFrame& at = window_.frames[static_cast<std::size_t>(frame)];
  const Eigen::Vector3d p_b = at.state.T_w_b.inverse() * window_.position(landmark);
  const Eigen::Vector3d rate_b = at.gyro_b - at.state.gyro_bias;
  const Eigen::Vector3d velocity_b = -(at.state.T_w_b.q.conjugate() * at.state.v_w) - rate_b.cross(p_b);
  const Eigen::Vector3d p_c = window_.T_b_c.inverse() * p_b;
  const Eigen::Vector3d velocity_c = window_.T_b_c.q.conjugate() * velocity_b;
  return (velocity_c.head<2>() - p_c.head<2>() / p_c.z() * velocity_c.z()) / p_c.z();
}

double ResidualBuilder::exposure_s(const Landmark& landmark, int frame) const {
  return landmark.in(frame).read_out_s - window_.frames[static_cast<std::size_t>(frame)].time_offset_s;
}

bool ResidualBuilder::uses_depth(const Observation& observation) const {
  return config_.depth.usage == DepthUsage::kWeighted && observation.depth > 0.0;
}

void ResidualBuilder::add_landmark(int index, std::vector<Residual>& out) {
  const Landmark& landmark = window_.landmarks[static_cast<std::size_t>(index)];
  const ReprojectionNoise noise{.bearing = bearing_sigma_,
                                .inverse_depth = config_.depth.inverse_sigma,
                                .depth_outlier = config_.depth.outlier_sigmas};
  const Observation& host = landmark.observations.front();
  if (uses_depth(host)) {
    out.push_back({std::make_unique<HostDepthFactor>(1.0 / host.depth, noise), nullptr, {}, index});
  }

  ReprojectionMeasurement m{.bearing_i = host.bearing,
                            .velocity_i = bearing_velocity(landmark, landmark.host),
                            .exposure_i_s = exposure_s(landmark, landmark.host)};
  for (int frame = landmark.host + 1; frame <= landmark.last(); ++frame) {
    const Observation& seen = landmark.in(frame);
    m.bearing_j = seen.bearing;
    m.velocity_j = bearing_velocity(landmark, frame);
    m.exposure_j_s = exposure_s(landmark, frame);
    std::unique_ptr<ceres::CostFunction> cost;
    if (uses_depth(seen)) {
      m.inverse_depth_j = 1.0 / seen.depth;
      cost = std::make_unique<ReprojectionFactor<3>>(m, noise);
    } else {
      cost = std::make_unique<ReprojectionFactor<2>>(m, noise);
    }
    out.push_back({std::move(cost),
                   loss_.get(),
                   {{BlockKind::kPose, landmark.host},
                    {BlockKind::kPose, frame},
                    {BlockKind::kExtrinsics},
                    {BlockKind::kTimeOffset}},
                   index});
  }
}

void ResidualBuilder::add_imu(int frame, std::vector<Residual>& out) {
  const std::optional<Preintegration>& imu = window_.frames[static_cast<std::size_t>(frame)].from_previous;
  if (!window_.inertial || !imu) return;
  out.push_back({std::make_unique<ImuFactor>(*imu, window_.gravity_w),
                 nullptr,
                 {{BlockKind::kPose, frame - 1},
                  {BlockKind::kSpeedBias, frame - 1},
                  {BlockKind::kPose, frame},
                  {BlockKind::kSpeedBias, frame}},
                 -1});
}

void ResidualBuilder::add_prior(std::vector<Residual>& out) {
  if (!window_.prior.empty()) out.push_back(prior_residual(window_.prior));
}

void ResidualBuilder::add_calibration(std::vector<Residual>& out) {
  if (!window_.calibration.empty()) out.push_back(prior_residual(window_.calibration));
}

}  // namespace stillpoint
