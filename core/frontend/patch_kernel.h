// SPDX-License-Identifier: BSD-3-Clause
/// Inverse-compositional Lucas-Kanade on 8x8 patches (Baker and Matthews 2004), in SIMD.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace stillpoint {

/// One picture of a pyramid. Pixels up to `kPatchReach` outside of it can be read.
struct PatchImage {
  const std::uint8_t* pixels = nullptr;  ///< the one at (0, 0)
  std::ptrdiff_t stride = 0;             ///< [bytes]
  int width = 0;
  int height = 0;
};

/// A patch with its gradients and interpolation, around a centre at the picture's edge, stays within this.
inline constexpr int kPatchReach = 8;

struct PatchPoint {
  float x = 0.0F;  ///< [px], pixel centres at whole numbers
  float y = 0.0F;
};

struct PatchSettings {
  int max_iterations = 30;       ///< per level
  float converged_px = 0.01F;    ///< step that ends the iteration
  float min_eigenvalue = 0.5F;   ///< of the mean gradient tensor [grey levels^2 / px^2]; less is no texture
  float min_correlation = 0.8F;  ///< of the patch with its match; less is no match
};

/// Which of the compiled instruction sets is used.
enum class PatchTarget {
  kBest,      ///< the best that this processor has
  kPortable,  ///< the one that every processor has; for tests and benchmarks
};

/// What `track_patches` reads and writes; points, matches and found run parallel.
struct PatchSearch {
  std::span<const PatchImage> from;    ///< the full picture first, each half as large as the one before
  std::span<const PatchImage> to;      ///< of as many levels
  std::span<const PatchPoint> points;  ///< centres in `from`
  std::span<PatchPoint> matches;       ///< where to begin in `to`; overwritten by where the search ended
  std::span<std::uint8_t> found;       ///< written: 1 where the patch was found, else 0
};

/// Finds patches of one picture in another, from the coarsest level to the finest.
///
/// At the finest level the patch of the next one takes part, in its own picture: it sees twice as far, which
/// steadies weak and blurred corners, at half of the cost of a patch with as many pixels more.
///
/// The gradients are those of the patch, computed once per level and freed of their mean: the search is blind
/// to a change of brightness. (Blind to contrast as well, it was less exact in noise.) Each lane holds one
/// column of the patch whatever the width of the processor's registers, and nothing is fused: every processor
/// gives the same bits.
void track_patches(const PatchSearch& search, const PatchSettings& settings,
                   PatchTarget target = PatchTarget::kBest);

}  // namespace stillpoint
