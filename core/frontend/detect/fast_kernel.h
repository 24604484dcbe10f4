// SPDX-License-Identifier: BSD-3-Clause
/// SIMD kernel that computes the FAST score of each pixel of a row. Rosten and Drummond 2006.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace stillpoint {

/// FAST-9 score: the highest threshold at which a pixel p is still a corner [grey levels],
///   score = max over arcs A of max(min_{q in A} I(q) - I(p), I(p) - max_{q in A} I(q)) - 1,
/// where A are the arcs of 9 contiguous pixels on the circle of 16 around p; 0 if score + 1 <= `threshold`.
/// Integer arithmetic: results are identical on all processors.
/// @param pixels first pixel of the row; 3 px around the row must be readable
/// @param stride of the image [bytes]
/// @param scores output, one per pixel
void score_fast_row(const std::uint8_t* pixels, std::ptrdiff_t stride, int threshold,
                    std::span<std::uint8_t> scores);

}  // namespace stillpoint
