// SPDX-License-Identifier: BSD-3-Clause
/// Monte Carlo simulation of the normalized estimation error (NEES) of the estimator.
#pragma once

#include <string>
#include <vector>

#include "core/config/odometry_config.h"
#include "core/types/rig.h"

namespace stillpoint {

/// One run. Noise, biases and the signs below are drawn from `seed`.
struct NeesDraw {
  std::uint32_t seed = 1;
  double pixel_noise_px = 0.5;
  double depth_noise = 0.003;   ///< standard deviation of 1/depth [1/m]
  double track_length_s = 2.0;  ///< 0 = while a point is visible
  double time_offset_s = 0.0;   ///< true one; the rig says 0
  double extrinsics_m = 0.0;    ///< error of the position in the rig, in a drawn direction
  double extrinsics_rad = 0.0;  ///< error of the rotation in the rig, about a drawn axis
  double depth_factor = 1.0;    ///< ratio of measured to true depth
};

/// Squared normalized error of one quantity, and its size.
struct NeesTerm {
  std::string quantity;
  int dimension = 0;
  double squared = 0.0;  ///< e^T P^-1 e
  double error = 0.0;    ///< |e|, SI units
};

/// Simulates a run and compares the state at the `checkpoints` [s] with the truth. Both are relative to the
/// pose that fixes the gauge, T_0^-1 T_k; there is no alignment. A frame without a valid state has no terms.
/// The terms "NIS reprojection" and "NIS inertial" are those of OdometryUpdate.
[[nodiscard]] std::vector<std::vector<NeesTerm>> simulate_nees(const OdometryConfig& config,
                                                               const NeesDraw& draw,
                                                               const std::vector<double>& checkpoints);

}  // namespace stillpoint
