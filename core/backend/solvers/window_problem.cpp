// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/window_problem.h"

#include "core/backend/factors/imu_factor.h"
#include "core/backend/factors/prior_factor.h"
#include "core/backend/factors/reprojection_factor.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

/// Below this speed the image motion is too small to observe time offset and extrinsics.
constexpr double kMinSpeedForCalibration = 0.2;  // [m/s]

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

void ParameterBlocks::assign(const Window& window) {
  frames_ = window.frames.size();
  values_.resize(16 * frames_ + 8 + window.landmarks.size());
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    const NavState& state = window.frames[i].state;
    pack_pose(state.T_w_b, pose(i));
    Eigen::Map<Eigen::Matrix<double, 9, 1>>{speed_bias(i)} << state.v_w, state.gyro_bias, state.accel_bias;
  }
  pack_pose(window.T_b_c, extrinsics());
  *time_offset() = window.time_offset_s;
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    *inverse_depth(i) = window.landmarks[i].inverse_depth;
  }
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

VariableCalibration variable_calibration(const Window& window, const BackendConfig& config) {
  const bool moving = window.inertial && window.frames.back().state.v_w.norm() > kMinSpeedForCalibration;
  return {.extrinsics = config.estimate_extrinsics && moving,
          .time_offset = config.estimate_time_offset && moving};
}

ResidualBuilder::ResidualBuilder(const Window& window, const BackendConfig& config, double focal_px)
    : window_(window),
      config_(config),
      noise_(reprojection_noise(config, focal_px)),
      loss_(std::make_unique<ceres::CauchyLoss>(config.cauchy_scale)) {
  observation_model_.read(window);
}

void ResidualBuilder::add_landmark(int index, std::vector<Residual>& out) {
  const Landmark& landmark = window_.landmarks[static_cast<std::size_t>(index)];
  const Observation& host = landmark.observations.front();
  if (uses_depth(host, config_)) {
    out.push_back({std::make_unique<HostDepthFactor>(1.0 / host.depth, noise_), nullptr, {}, index});
  }

  const Eigen::Vector3d position_w = observation_model_.position(landmark);
  const TimedBearing in_host = observation_model_.at(landmark, landmark.host, position_w);
  ReprojectionMeasurement m{
      .bearing_i = in_host.bearing, .velocity_i = in_host.velocity, .exposure_i_s = in_host.exposure_s};
  for (int frame = landmark.host + 1; frame <= landmark.last(); ++frame) {
    const Observation& observation = landmark.observation_in(frame);
    const TimedBearing timed = observation_model_.at(landmark, frame, position_w);
    m.bearing_j = timed.bearing;
    m.velocity_j = timed.velocity;
    m.exposure_j_s = timed.exposure_s;
    std::unique_ptr<ceres::CostFunction> cost;
    if (uses_depth(observation, config_)) {
      m.inverse_depth_j = 1.0 / observation.depth;
      cost = std::make_unique<ReprojectionFactor<3>>(m, noise_);
    } else {
      cost = std::make_unique<ReprojectionFactor<2>>(m, noise_);
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
