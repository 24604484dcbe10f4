// SPDX-License-Identifier: BSD-3-Clause
/// Replicates of a deterministic run: a negligible perturbation of its input, and hashes of the module states
/// after each frame, of which the first difference locates where two runs diverge.
///
/// The odometry is deterministic, but a different rounding may change a decision (an inlier, a keyframe), and
/// with it the result. Runs with different perturbations are replicates from which the size of such changes
/// is measured:
///
///   w' = w (1 + r u),  z' = z (1 + r u),  b' = b + (z' - z) / f
///
/// w: angular rate, each axis; z: pixel of a feature, each coordinate; b: its bearing; f: focal length [px];
/// r = 1e-9; u: uniform in [-1, 1), a function of seed, time, axis and feature id. It does not depend on the
/// order of calls, so all modes of execution, and both stages, see the same input.
#pragma once

#include <cstdint>
#include <span>

#include "core/types/nav_state.h"
#include "core/types/odometry_update.h"
#include "core/types/rig.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// FNV-1a, 64 bits (Fowler, Noll, Vo 1991), over the bit patterns of all values.
[[nodiscard]] std::uint64_t state_hash(std::span<const TrackedFeature> features);
[[nodiscard]] std::uint64_t state_hash(std::span<const DynamicLabel> labels);
[[nodiscard]] std::uint64_t state_hash(const NavState& state);

/// Perturbation of one run, see above.
class InputPerturbation {
 public:
  /// @param seed 0: nothing is changed, not a single bit
  /// @param focal_px focal length of the camera
  InputPerturbation(int seed, double focal_px) : seed_(seed), focal_px_(focal_px) {}

  /// The sample with a perturbed angular rate.
  [[nodiscard]] ImuSample of(const ImuSample& sample) const;

  /// Perturbs pixels and bearings of the features; without allocations.
  void perturb(TrackedFrame& frame) const;

 private:
  int seed_;
  double focal_px_;
};

}  // namespace stillpoint
