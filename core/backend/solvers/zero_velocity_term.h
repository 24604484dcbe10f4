// SPDX-License-Identifier: BSD-3-Clause
/// Zero-velocity factor of a frame at rest: the residual r = v_w / sigma, see `ZeroVelocityConfig`.
#pragma once

#include "core/backend/solvers/reduced_system.h"

namespace stillpoint {

/// Whether a frame has the factor.
[[nodiscard]] inline bool has_zero_velocity_term(const Window& window, int frame) {
  return window.inertial && window.frames[static_cast<std::size_t>(frame)].at_rest;
}

/// Cost 1/2 |r|^2 of the factors of all frames.
[[nodiscard]] double zero_velocity_cost(const Window& window, const BackendConfig& config,
                                        const ParameterBlocks& blocks);

/// Adds J^T J and J^T r of the factor of a frame that has one. @return the cost
double add_zero_velocity_term(int frame, const BackendConfig& config, const ParameterBlocks& blocks,
                              ReducedSystem& system);

}  // namespace stillpoint
