// SPDX-License-Identifier: BSD-3-Clause
/// Texture map with mip levels (Williams 1983), which avoid aliasing of distant surfaces.
#pragma once

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

  /// Bilinear interpolation at (s, t), in repeats of the texture, in mip level floor(`level`), clamped.
  [[nodiscard]] Float4 sample(float s, float t, float level) const;

 private:
  struct Level {
    int width;
    int height;
    std::size_t first;
  };
  std::vector<Level> levels_;
  std::vector<std::uint32_t> texels_;
};

}  // namespace stillpoint::synth
