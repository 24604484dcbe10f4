// SPDX-License-Identifier: BSD-3-Clause
/// Where a patch lies between pixels, and the step that its slopes ask for: the scalar part of the search.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/frontend/patch_kernel.h"

namespace stillpoint {

inline constexpr std::size_t kPatchSide = 8;

/// The pixel above and left of a place, and the shares of its neighbours.
struct Place {
  const std::uint8_t* pixels;
  std::ptrdiff_t stride;
  float share_x;
  float share_y;
};

/// Of the patch's upper left pixel. @return false where the centre is not in the picture
[[nodiscard]] inline bool place_at(const PatchImage& image, PatchPoint centre, Place& place) {
  const bool inside = centre.x >= 0.0F && centre.y >= 0.0F &&
                      centre.x <= static_cast<float>(image.width - 1) &&
                      centre.y <= static_cast<float>(image.height - 1);
  if (!inside) return false;  // nor where it is not a number
  constexpr float kHalf = 0.5F * (kPatchSide - 1);
  const float x = std::floor(centre.x - kHalf);
  const float y = std::floor(centre.y - kHalf);
  place = {
      .pixels = image.pixels + static_cast<std::ptrdiff_t>(y) * image.stride + static_cast<std::ptrdiff_t>(x),
      .stride = image.stride,
      .share_x = centre.x - kHalf - x,
      .share_y = centre.y - kHalf - y};
  return true;
}

/// A symmetric matrix.
struct Tensor {
  float xx = 0.0F, xy = 0.0F, yy = 0.0F;

  [[nodiscard]] float smaller_eigenvalue() const {
    return 0.5F * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4.0F * xy * xy));
  }
};

/// With what a level of half the resolution says, where a step of one pixel is half a pixel.
[[nodiscard]] inline PatchPoint joined(PatchPoint slope, PatchPoint coarse) {
  return {slope.x + 0.5F * coarse.x, slope.y + 0.5F * coarse.y};
}
[[nodiscard]] inline Tensor joined(const Tensor& fine, const Tensor& coarse) {
  return {.xx = fine.xx + 0.25F * coarse.xx,
          .xy = fine.xy + 0.25F * coarse.xy,
          .yy = fine.yy + 0.25F * coarse.yy};
}

/// The step that the slopes ask for.
[[nodiscard]] inline PatchPoint newton_step(const Tensor& tensor, PatchPoint slope) {
  const float scale = -1.0F / (tensor.xx * tensor.yy - tensor.xy * tensor.xy);
  return {scale * (tensor.yy * slope.x - tensor.xy * slope.y),
          scale * (tensor.xx * slope.y - tensor.xy * slope.x)};
}

}  // namespace stillpoint
