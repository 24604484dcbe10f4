// SPDX-License-Identifier: BSD-3-Clause
/// Texture map with mip levels (Williams 1983), which avoid aliasing of distant surfaces.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillpoint::synth {

/// SIMD vector of red, green, blue and one unused lane; a compiler extension of GCC and Clang.
using Float4 = float __attribute__((vector_size(16)));

/// Repeating texture. Values are square roots of reflectance, 0..1, which resolves dark tones in eight bits.
class Texture {
 public:
  /// @param rgb CV_8UC3 with power-of-two sides
  explicit Texture(const cv::Mat& rgb);

  [[nodiscard]] int width() const { return levels_.front().width; }
  [[nodiscard]] int height() const { return levels_.front().height; }

  /// The four texels around a point, and the weights of the right and the lower ones.
  struct Cell {
    const std::uint32_t* upper;  ///< rows of texels
    const std::uint32_t* lower;
    int column, next_column;
    float weight_x, weight_y;

    /// Bilinear interpolation.
    [[nodiscard]] Float4 value() const;
  };

  /// A color as it is stored.
  [[nodiscard]] static std::uint32_t packed(const cv::Vec3b& rgb) {
    return static_cast<std::uint32_t>(rgb[0] | rgb[1] << 8 | rgb[2] << 16);
  }

  /// The texels at (s, t), in repeats of the texture, in mip level floor(`level`), clamped.
  [[nodiscard]] Cell cell_at(float s, float t, float level) const;

 private:
  struct Level {
    int width;
    int height;
    std::size_t first;
  };
  std::vector<Level> levels_;
  std::vector<std::uint32_t> texels_;
};

// Inline, because they are called for each ray.

inline Texture::Cell Texture::cell_at(float s, float t, float level) const {
  const auto highest = static_cast<int>(levels_.size()) - 1;
  const Level& mip = levels_[static_cast<std::size_t>(std::clamp(static_cast<int>(level), 0, highest))];
  const float x = s * static_cast<float>(mip.width) - 0.5F;
  const float y = t * static_cast<float>(mip.height) - 0.5F;
  const float floor_x = std::floor(x), floor_y = std::floor(y);
  const int column = static_cast<int>(floor_x) & (mip.width - 1),
            row = static_cast<int>(floor_y) & (mip.height - 1);
  const int next_column = (column + 1) & (mip.width - 1), next_row = (row + 1) & (mip.height - 1);
  const std::uint32_t* const texels = texels_.data() + mip.first;
  return {.upper = texels + static_cast<std::size_t>(row * mip.width),
          .lower = texels + static_cast<std::size_t>(next_row * mip.width),
          .column = column,
          .next_column = next_column,
          .weight_x = x - floor_x,
          .weight_y = y - floor_y};
}

inline Float4 Texture::Cell::value() const {
  const auto unpack = [](std::uint32_t texel) {
    using Bytes = std::uint8_t __attribute__((vector_size(4)));
    return __builtin_convertvector(std::bit_cast<Bytes>(texel), Float4);
  };
  const Float4 a = unpack(upper[column]), b = unpack(upper[next_column]);
  const Float4 c = unpack(lower[column]), d = unpack(lower[next_column]);
  const Float4 top = a + (b - a) * weight_x;
  const Float4 bottom = c + (d - c) * weight_x;
  return (top + (bottom - top) * weight_y) * (1.0F / 255.0F);
}

}  // namespace stillpoint::synth
