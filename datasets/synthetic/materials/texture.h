// SPDX-License-Identifier: BSD-3-Clause
/// Texture map with mip levels (Williams 1983), which avoid aliasing of distant surfaces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace stillpoint::synth {

/// Repeating texture. Values are square roots of reflectance, 0..1, which resolves dark tones in eight bits.
/// Copies share the texels, which do not change.
class Texture {
 public:
  /// @param rgb CV_8UC3 with power-of-two sides
  explicit Texture(const cv::Mat& rgb);

  [[nodiscard]] int width() const { return levels_.front().width; }
  [[nodiscard]] int height() const { return levels_.front().height; }

  /// Rows of texels, each followed by its first texel again. Sides are powers of two.
  struct Level {
    int width, height;
    const std::uint32_t* texels;
  };

  [[nodiscard]] int highest_level() const { return static_cast<int>(levels_.size()) - 1; }
  /// @param number 0 .. highest_level()
  [[nodiscard]] Level level(int number) const {
    const Sides& sides = levels_[static_cast<std::size_t>(number)];
    return {sides.width, sides.height, texels_.get() + sides.first};
  }

  /// A color as it is stored.
  [[nodiscard]] static std::uint32_t packed(const cv::Vec3b& rgb) {
    return static_cast<std::uint32_t>(rgb[0] | rgb[1] << 8 | rgb[2] << 16);
  }

 private:
  struct Sides {
    int width;
    int height;
    std::size_t first;  ///< in texels_
  };
  std::vector<Sides> levels_;
  std::shared_ptr<std::uint32_t[]> texels_;
};

}  // namespace stillpoint::synth
