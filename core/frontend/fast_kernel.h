// SPDX-License-Identifier: BSD-3-Clause
/// How strong a FAST corner each pixel of a row is (Rosten and Drummond 2006), in SIMD.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace stillpoint {

/// Of the circle of 16 pixels around a pixel, the arc of 9 that is brightest or darkest against it: its least
/// contrast less 1 [grey levels], which is the highest threshold at which the pixel still is a corner. 0
/// where the contrast is not above `threshold`. Whole numbers: every processor gives the same bits.
/// @param pixels the first one; 3 px around all of them can be read
/// @param stride of the picture [bytes]
/// @param scores one for each pixel, overwritten
void score_fast_row(const std::uint8_t* pixels, std::ptrdiff_t stride, int threshold,
                    std::span<std::uint8_t> scores);

}  // namespace stillpoint
