// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/reference/ceres_residuals.h"

#include "core/backend/reference/reprojection_factor.h"
#include "core/backend/reference/state_factors.h"

namespace stillpoint {
namespace {

Residual prior_residual(const LinearPrior& prior) {
  Residual residual{std::make_unique<PriorFactor>(prior), nullptr, {}, -1};
  for (const PriorBlock& block : prior.blocks) residual.states.push_back({block.kind, block.frame});
  return residual;
}

}  // namespace

ResidualBuilder::ResidualBuilder(const Window& window, const BackendConfig& config, double focal_px)
    : window_(window),
      config_(config),
      noise_(reprojection_noise(config, focal_px)),
      loss_(std::make_unique<ceres::CauchyLoss>(config.cauchy_scale)) {
  observation_model_.read(window);
}

/// Linearization point of a state that the prior involves; null with the published prior.
const double* ResidualBuilder::first_estimate(BlockRef block) const {
  if (config_.prior != PriorModel::kConsistent) return nullptr;
  for (const PriorBlock& known : window_.prior.blocks) {
    if (known.kind == block.kind && known.frame == block.frame) return known.linearization.data();
  }
  return nullptr;
}

/// The loss times the fraction of the information that is not in the prior.
ceres::LossFunction* ResidualBuilder::scaled_loss(ceres::LossFunction* loss, double information) {
  if (information == 1.0) return loss;
  scaled_losses_.push_back(
      std::make_unique<ceres::ScaledLoss>(loss, information, ceres::DO_NOT_TAKE_OWNERSHIP));
  return scaled_losses_.back().get();
}

void ResidualBuilder::add_landmark(int index) {
  const Landmark& landmark = window_.landmarks[static_cast<std::size_t>(index)];
  const Observation& host = landmark.observations.front();
  if (uses_depth(host, config_)) {
    residuals_.push_back({std::make_unique<HostDepthFactor>(1.0 / host.depth, noise_),
                          scaled_loss(nullptr, host.information),
                          {{BlockKind::kDepthScale}},
                          index});
  }

  const Eigen::Vector3d position_w = observation_model_.position(landmark);
  const TimedBearing in_host = observation_model_.at(landmark, landmark.host, position_w);
  ReprojectionMeasurement m{.bearing_i = in_host.bearing,
                            .seen_i = in_host.seen,
                            .lens = window_.lens,
                            .velocity_i = in_host.velocity,
                            .exposure_i_s = in_host.exposure_s};
  for (int frame = landmark.host + 1; frame <= landmark.last(); ++frame) {
    const std::array<const double*, 3> first = {first_estimate({BlockKind::kPose, landmark.host}),
                                                first_estimate({BlockKind::kPose, frame}),
                                                first_estimate({BlockKind::kExtrinsics})};
    const Observation& observation = landmark.observation_in(frame);
    const TimedBearing timed = observation_model_.at(landmark, frame, position_w);
    m.bearing_j = timed.bearing;
    m.seen_j = timed.seen;
    m.velocity_j = timed.velocity;
    m.exposure_j_s = timed.exposure_s;
    std::unique_ptr<ceres::CostFunction> cost;
    std::vector<BlockRef> states = {{BlockKind::kPose, landmark.host},
                                    {BlockKind::kPose, frame},
                                    {BlockKind::kExtrinsics},
                                    {BlockKind::kTimeOffset},
                                    {BlockKind::kLens}};
    if (uses_depth(observation, config_)) {
      m.inverse_depth_j = 1.0 / observation.depth;
      cost = std::make_unique<ReprojectionFactor<3>>(m, noise_, first);
      states.push_back({BlockKind::kDepthScale});
    } else {
      cost = std::make_unique<ReprojectionFactor<2>>(m, noise_, first);
    }
    residuals_.push_back(
        {std::move(cost), scaled_loss(loss_.get(), observation.information), std::move(states), index});
  }
}

void ResidualBuilder::add_imu(int frame) {
  const std::optional<Preintegration>& imu = window_.frames[static_cast<std::size_t>(frame)].from_previous;
  if (!window_.inertial || !imu) return;
  std::vector<BlockRef> states = {{BlockKind::kPose, frame - 1}, {BlockKind::kSpeedBias, frame - 1},
                                  {BlockKind::kPose, frame},     {BlockKind::kSpeedBias, frame},
                                  {BlockKind::kGravity},         {BlockKind::kTimeOffset}};
  ImuFactor::FirstEstimates first{};
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (states[i].kind != BlockKind::kTimeOffset) first[i] = first_estimate(states[i]);
  }
  residuals_.push_back(
      {std::make_unique<ImuFactor>(*imu, window_.imu_ends(frame), first), nullptr, std::move(states), -1});
}

void ResidualBuilder::add_prior() {
  if (!window_.prior.empty()) residuals_.push_back(prior_residual(window_.prior));
}

void ResidualBuilder::add_states() {
  add_prior();
  if (!window_.calibration.empty()) residuals_.push_back(prior_residual(window_.calibration));
  for (int frame = 1; frame <= window_.newest(); ++frame) add_imu(frame);
}

}  // namespace stillpoint
