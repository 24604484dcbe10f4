// SPDX-License-Identifier: BSD-3-Clause
/// Binary descriptors of 256 bits.
#pragma once

#include <bit>

#include "core/types/keyframe_map.h"

namespace stillpoint {

/// Number of different bits, 0 to 256.
[[nodiscard]] inline int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

}  // namespace stillpoint
