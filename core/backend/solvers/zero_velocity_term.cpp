// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/solvers/zero_velocity_term.h"

namespace stillpoint {
namespace {

Eigen::Vector3d zero_velocity_residual(const ParameterBlocks& blocks, int frame,
                                       const BackendConfig& config) {
  return Eigen::Map<const Eigen::Vector3d>(blocks.at({BlockKind::kSpeedBias, frame})) /
         config.zero_velocity.sigma_m_per_s;
}

}  // namespace

double zero_velocity_cost(const Window& window, const BackendConfig& config, const ParameterBlocks& blocks) {
  double cost = 0.0;
  for (int frame = 0; frame <= window.newest(); ++frame) {
    if (has_zero_velocity_term(window, frame))
      cost += 0.5 * zero_velocity_residual(blocks, frame, config).squaredNorm();
  }
  return cost;
}

double add_zero_velocity_term(int frame, const BackendConfig& config, const ParameterBlocks& blocks,
                              ReducedSystem& system) {
  const Eigen::Vector3d residual = zero_velocity_residual(blocks, frame, config);
  const double sigma = config.zero_velocity.sigma_m_per_s;
  const int column = system.layout.column({BlockKind::kSpeedBias, frame});
  system.H.diagonal().segment<3>(column).array() += 1.0 / (sigma * sigma);
  system.g.segment<3>(column) += residual / sigma;
  return 0.5 * residual.squaredNorm();
}

}  // namespace stillpoint
