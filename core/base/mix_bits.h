// SPDX-License-Identifier: BSD-3-Clause
/// Hash of 64 bits, for random numbers that are a function of key and counter only.
#pragma once

#include <cstdint>

namespace stillpoint {

/// Finalizer of SplitMix64 (Steele, Lea, Flood 2014): a bijection whose output bits look independent.
[[nodiscard]] constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

}  // namespace stillpoint
