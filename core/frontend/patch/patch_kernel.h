// SPDX-License-Identifier: BSD-3-Clause
/// Inverse-compositional Lucas-Kanade on 8x8 patches (Baker and Matthews 2004), in SIMD.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace stillpoint {

/// One pyramid level. Pixels up to `kPatchReach` outside the image must be readable.
struct PatchImage {
  const std::uint8_t* pixels = nullptr;  ///< pixel (0, 0)
  std::ptrdiff_t stride = 0;             ///< [bytes]
  int width = 0;
  int height = 0;
};

/// Pixels that a patch centered on the image edge needs beyond it, including gradients and interpolation.
inline constexpr int kPatchReach = 8;

struct PatchPoint {
  float x = 0.0F;  ///< [px], pixel centers have integer coordinates
  float y = 0.0F;
};

struct PatchSettings {
  int max_iterations = 30;       ///< per level, as of cv::calcOpticalFlowPyrLK
  float converged_px = 0.01F;    ///< step that ends the iteration
  float min_eigenvalue = 0.5F;   ///< of the structure tensor per pixel [grey levels^2 / px^2]; texture test
  float min_correlation = 0.8F;  ///< zero-mean normalized cross-correlation required of a match
};

/// Instruction set to use (a "target" of Highway).
enum class PatchTarget {
  kBest,      ///< the best one supported by this processor
  kPortable,  ///< without SIMD instructions; for tests and benchmarks
};

/// Input and output of `track_patches`; points, matches and found are parallel arrays.
struct PatchSearch {
  std::span<const PatchImage> from;    ///< pyramid, full resolution first, halved at each level
  std::span<const PatchImage> to;      ///< pyramid with the same number of levels
  std::span<const PatchPoint> points;  ///< patch centers in `from`
  std::span<PatchPoint> matches;       ///< in: initial guesses in `to`; out: final positions
  std::span<std::uint8_t> found;       ///< out: 1 = found, 0 = not found
};

/// Tracks 8x8 patches from one image to another, from the coarsest pyramid level to the finest.
///
/// Inverse-compositional Gauss-Newton for a translation p (Baker and Matthews 2004, Sec. 3.2): with the
/// template T (the patch in `from`) and the image I (`to`), each iteration minimizes over dp and beta
///   sum_x [T(x + dp) + beta - I(x + p)]^2, and composes with the inverse: p <- p - dp.
/// The additive offset beta makes it invariant to brightness. Eliminating beta removes the patch mean from
/// the gradient grad T, giving G(x), and leaves
///   H = sum_x G G^T,  g = sum_x G(x) [I(x + p) - T(x)],  p <- p - H^-1 g.
/// G, H and sum_x G T are computed once per patch and level; an iteration only evaluates sum_x G I(x + p).
/// It stops at |dp| < `converged_px` or after `max_iterations`. A match is accepted if the zero-mean
/// normalized cross-correlation of T and I(x + p) at the finest level is at least `min_correlation`.
/// (Invariance to contrast as well was less accurate on noisy images.)
///
/// The finest level adds the terms of the next coarser level around the same point: g = g_0 + g_1 / 2,
/// H = H_0 + H_1 / 4. This doubles the support of the patch, which stabilizes weak and blurred corners, at
/// half the cost of a patch with as many additional pixels.
///
/// Each SIMD lane holds one column of the patch for any register width, and multiply-add is not fused:
/// results are bit-identical on all processors.
void track_patches(const PatchSearch& search, const PatchSettings& settings,
                   PatchTarget target = PatchTarget::kBest);

}  // namespace stillpoint
