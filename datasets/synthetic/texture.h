// SPDX-License-Identifier: BSD-3-Clause
/// A picture on a surface, with its mip levels (Williams 1983), so that far surfaces do not alias.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillpoint {

/// Four numbers handled as one (red, green, blue, unused); a compiler extension of GCC and Clang.
using Float4 = float __attribute__((vector_size(16)));

/// Tiled picture. Values are square roots of reflectance, 0..1: eight bits then reach well into the dark.
class Texture {
 public:
  /// @param rgb CV_8UC3 whose sides are powers of two
  explicit Texture(const cv::Mat& rgb);

  [[nodiscard]] int width() const { return levels_.front().width; }
  [[nodiscard]] int height() const { return levels_.front().height; }

  /// Bilinear value at (s, t), repeats of the picture, in the mip level nearest below `level`.
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

}  // namespace stillpoint
