// SPDX-License-Identifier: BSD-3-Clause
/// Scalar part of the patch tracker: bilinear sampling position, sums and Gauss-Newton step.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/frontend/patch/patch_kernel.h"

namespace stillpoint {

inline constexpr std::size_t kPatchSide = 8;

/// Bilinear sampling position of a patch: the pixel at or above left of its upper left sample, and the
/// fractional offset from it, i.e. the interpolation weights of the next column and row.
struct PatchSampler {
  const std::uint8_t* pixels;
  std::ptrdiff_t stride;
  float frac_x;
  float frac_y;
};

/// Whether the image contains a point; false if a coordinate is NaN.
[[nodiscard]] inline bool is_inside(const PatchImage& image, PatchPoint point) {
  return point.x >= 0.0F && point.y >= 0.0F && point.x <= static_cast<float>(image.width - 1) &&
         point.y <= static_cast<float>(image.height - 1);
}

/// Sampling position of the patch around `center`. @return nullopt if the center is not inside the image
[[nodiscard]] inline std::optional<PatchSampler> make_sampler(const PatchImage& image, PatchPoint center) {
  if (!is_inside(image, center)) return std::nullopt;
  constexpr float kHalf = 0.5F * (kPatchSide - 1);
  const float x = std::floor(center.x - kHalf);
  const float y = std::floor(center.y - kHalf);
  return PatchSampler{
      .pixels = image.pixels + static_cast<std::ptrdiff_t>(y) * image.stride + static_cast<std::ptrdiff_t>(x),
      .stride = image.stride,
      .frac_x = center.x - kHalf - x,
      .frac_y = center.y - kHalf - y};
}

/// Sums over a patch before the means are removed: grey (G), grad_x (X), grad_y (Y) and their products.
enum Moment : std::size_t { kG, kX, kY, kGG, kGX, kGY, kXX, kXY, kYY, kMoments };
using Moments = std::array<float, kMoments>;

/// Structure tensor of a patch, sum of grad grad^T: the Gauss-Newton Hessian H of the patch search.
struct StructureTensor {
  float xx = 0.0F, xy = 0.0F, yy = 0.0F;

  [[nodiscard]] float smaller_eigenvalue() const {
    return 0.5F * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4.0F * xy * xy));
  }
};

/// Adds the terms of the next coarser level, where a step of 1 px is a step of 1/2 px:
/// g = g_fine + g_coarse / 2, H = H_fine + H_coarse / 4.
[[nodiscard]] inline PatchPoint add_coarse(PatchPoint gradient, PatchPoint coarse) {
  return {gradient.x + 0.5F * coarse.x, gradient.y + 0.5F * coarse.y};
}
[[nodiscard]] inline StructureTensor add_coarse(const StructureTensor& fine, const StructureTensor& coarse) {
  return {.xx = fine.xx + 0.25F * coarse.xx,
          .xy = fine.xy + 0.25F * coarse.xy,
          .yy = fine.yy + 0.25F * coarse.yy};
}

/// Step -H^-1 g.
[[nodiscard]] inline PatchPoint gauss_newton_step(const StructureTensor& hessian, PatchPoint gradient) {
  const float scale = -1.0F / (hessian.xx * hessian.yy - hessian.xy * hessian.xy);
  return {scale * (hessian.yy * gradient.x - hessian.xy * gradient.y),
          scale * (hessian.xx * gradient.y - hessian.xy * gradient.x)};
}

/// Last position of a search; without a match, also outside the image.
struct PatchMatch {
  PatchPoint position;
  bool found;
};

}  // namespace stillpoint
