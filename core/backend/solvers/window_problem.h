// SPDX-License-Identifier: BSD-3-Clause
/// What all solvers share: the parameter blocks of a window, and the rules of its residuals.
#pragma once

#include <vector>

#include "core/backend/factors/reprojection_rows.h"
#include "core/backend/window/window.h"
#include "core/config/backend_config.h"

namespace stillpoint {

/// One block of the window's states; `frame` is -1 for global states.
struct BlockRef {
  BlockKind kind = BlockKind::kPose;
  int frame = -1;
};

/// Copies of the window's states in the solver's layout: T_w_b of each frame as (p, q xyzw), then each
/// frame's v, gyro bias and accel bias, then T_b_c, the time offset, gravity, the inverse depth scale, the
/// lens, and the inverse depth of each landmark, usable or not.
///
/// A single array: Ceres orders blocks by address, so with separate arrays the elimination order, and thereby
/// the rounding of the result, would depend on the allocator.
class ParameterBlocks {
 public:
  ParameterBlocks() = default;
  explicit ParameterBlocks(const Window& window) { assign(window); }

  /// Copies the states of a window; allocates only if it is larger than all windows before.
  void assign(const Window& window);

  [[nodiscard]] double* at(BlockRef block) { return &values_[offset(block)]; }
  [[nodiscard]] double* inverse_depth(std::size_t landmark) { return &values_[first_landmark() + landmark]; }
  [[nodiscard]] const double* at(BlockRef block) const { return &values_[offset(block)]; }
  [[nodiscard]] const double* inverse_depth(std::size_t landmark) const {
    return &values_[first_landmark() + landmark];
  }

 private:
  [[nodiscard]] std::size_t offset(BlockRef block) const;
  [[nodiscard]] std::size_t first_landmark() const { return 16 * frames_ + 16; }

  std::size_t frames_ = 0;
  std::vector<double> values_;
};

/// States, and the point at which Jacobians are evaluated.
struct Linearization {
  const ParameterBlocks& states;
  const ParameterBlocks& point;

  [[nodiscard]] bool at_first_estimates() const { return &states != &point; }
};

/// Linearization at the states `now`. With the published prior Jacobians are evaluated there. With the
/// consistent one the states that the prior involves are replaced by their linearization points in the prior
/// (first-estimates Jacobians, Huang et al. 2009): the null space of the prior is that at its linearization
/// points, and if the other residuals had another one, the world would gain information about its own
/// position and orientation. Time offset, depth scale and lens remain at `now`: a displacement does not
/// change them.
/// @param point storage for the point
[[nodiscard]] Linearization linearize_at(const ParameterBlocks& now, const Window& window,
                                         const BackendConfig& config, ParameterBlocks& point);

/// Writes the values of the blocks back to the states of the window, and corrects its bearings by the lens.
void unpack(const ParameterBlocks& blocks, Window& window);

/// Standard deviations of the visual residuals.
[[nodiscard]] ReprojectionNoise reprojection_noise(const BackendConfig& config, double focal_px);

/// Whether a landmark's inverse depth is constant at its measured value (as in the published system).
[[nodiscard]] bool has_constant_depth(const Landmark& landmark, const BackendConfig& config);

/// Whether the measured depth of an observation is used as a residual.
[[nodiscard]] bool uses_depth(const Observation& observation, const BackendConfig& config);

/// Whether the extrinsics are estimated: always, or since rotations contradict those of the rig.
[[nodiscard]] inline bool estimates_extrinsics(const Window& window, const BackendConfig& config) {
  return config.estimate_extrinsics || window.is_realigned;
}

/// Which global states are variable.
struct VariableGlobals {
  bool extrinsics = false;
  bool time_offset = false;
  bool gravity = false;
  bool depth_scale = false;
  bool lens = false;

  [[nodiscard]] bool has(BlockKind kind) const;
};
/// Appends the variable global states.
[[nodiscard]] std::vector<BlockRef> with_globals(std::vector<BlockRef> blocks, VariableGlobals variable);
/// In the covariance.
[[nodiscard]] VariableGlobals variable_globals(const Window& window, const BackendConfig& config);
/// In the solve: without the calibration that agrees with the rig.
[[nodiscard]] VariableGlobals solved_globals(const Window& window, const BackendConfig& config);
/// In marginalize_oldest. With the published prior extrinsics and time offset are constant there.
[[nodiscard]] VariableGlobals marginalized_globals(const Window& window, const BackendConfig& config);

/// Fraction of the information of a landmark of the oldest frame that marginalize_oldest adds to the prior.
///
/// A track that continues in the newest frame stays in the window with its other observations, hosted in the
/// next frame. With the published prior all of its information enters the prior, and the observations that
/// stay enter again with the next frame. With the consistent one a fraction a of the information of each
/// observation enters the prior, and 1 - a remains: the likelihood of an observation is a product of powers,
/// p = p^a p^(1-a), whose exponents sum up to at most one (as in covariance intersection, Julier and Uhlmann
/// 1997). Only that both factors belong to the same point is lost. The whole information of a track that
/// ended enters the prior.
///
/// In a track that is longer than the window, an observation that n slides have reduced has the weight
/// (1 - a)^n. The point is determined by about 1 / a frames: two with a = 1/2, so that the estimate drifts as
/// if the window were that short. What remains when the frame of an observation leaves is lost, which for a
/// window of ten frames is (1 - a)^10, a tenth with a = 1/5.
[[nodiscard]] double marginalized_fraction(const Landmark& landmark, const Window& window,
                                           const BackendConfig& config);

/// Removes the information that marginalize_oldest adds to the prior from the observations in the window;
/// tracks of which nothing remains are left with the observation in the oldest frame.
void remove_marginalized_information(const BackendConfig& config, Window& window);

/// Blocks that the prior of marginalize_oldest may involve: the states after the oldest frame, and
/// `marginalized_globals`.
/// @param recycled storage for the result; its content is ignored
[[nodiscard]] std::vector<BlockRef> candidate_blocks(const Window& window, const BackendConfig& config,
                                                     std::vector<BlockRef> recycled = {});

/// The block of a prior linearized at `point`, with its frame index after the oldest frame was removed.
[[nodiscard]] PriorBlock prior_block_after_slide(BlockRef block, const ParameterBlocks& point);

/// Moves the residual of a prior from the states `now` (before the slide) to its linearization point x0:
/// r0 = r(now) - J (now [-] x0).
void move_residual_to_linearization(const ParameterBlocks& now, LinearPrior& prior);

}  // namespace stillpoint
