// SPDX-License-Identifier: BSD-3-Clause
/// Conversion of color to gray.
#pragma once

#include <cstdint>

namespace stillpoint::datasets {

/// Luma of ITU-R BT.601, Y = 0.299 R + 0.587 G + 0.114 B, with weights in 1/2^14, rounded.
[[nodiscard]] constexpr std::uint8_t luma(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  return static_cast<std::uint8_t>((4899 * red + 9617 * green + 1868 * blue + 8192) >> 14);
}

}  // namespace stillpoint::datasets
