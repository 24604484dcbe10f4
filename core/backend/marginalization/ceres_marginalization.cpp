// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "core/backend/marginalization/normal_equations.h"
#include "core/backend/solvers/ceres_solver.h"

namespace stillpoint {
namespace {

/// Appends `size` columns from `first` on.
std::vector<int> with_columns(std::vector<int> columns, int first, int size) {
  for (int i = 0; i < size; ++i) columns.push_back(first + i);
  return columns;
}

NormalEquations linearize_oldest(const Window& window, const BackendConfig& config, double focal_px,
                                 const ParameterBlocks& blocks) {
  NormalEquations equations(static_cast<int>(window.frames.size()));
  ResidualBuilder builder(window, config, focal_px);
  builder.add_prior();
  if (window.newest() >= 1) builder.add_imu(1);
  builder.add_zero_velocity(0);
  equations.add(builder.residuals(), blocks, false);
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    const Landmark& landmark = window.landmarks[i];
    if (landmark.host != 0 || !is_usable(landmark)) continue;
    builder.clear();
    builder.add_landmark(static_cast<int>(i));
    equations.add(builder.residuals(), blocks, has_constant_depth(landmark, config),
                  marginalized_fraction(landmark, window, config));
  }
  return equations;
}

}  // namespace

LinearPrior CeresSolver::marginalize_oldest(const Window& window, const BackendConfig& config,
                                            double focal_px, LinearPrior /*recycled*/) {
  const ParameterBlocks blocks(window);
  const NormalEquations equations = linearize_oldest(window, config, focal_px, blocks);
  const StateLayout& layout = equations.layout;

  std::vector<int> marginalized = with_columns({}, layout.column({BlockKind::kPose, 0}), 6);
  if (window.inertial)
    marginalized = with_columns(std::move(marginalized), layout.column({BlockKind::kSpeedBias, 0}), 9);

  ParameterBlocks point;
  const Linearization at = linearize_at(blocks, window, config, point);
  LinearPrior prior;
  std::vector<int> remaining;
  for (const BlockRef block : candidate_blocks(window, config)) {
    const int column = layout.column(block);
    const int size = local_size(block.kind);
    if (equations.H.diagonal().segment(column, size).isZero(0.0)) continue;
    remaining = with_columns(std::move(remaining), column, size);
    prior.blocks.push_back(prior_block_after_slide(block, at.point));
  }
  if (remaining.empty()) return prior;
  SquareRoot root = eliminate(equations.H, equations.b, marginalized, remaining);
  prior.jacobian = std::move(root.jacobian);
  prior.residual = std::move(root.residual);
  if (at.at_first_estimates()) move_residual_to_linearization(blocks, prior);
  return prior;
}

}  // namespace stillpoint
