// SPDX-License-Identifier: BSD-3-Clause
/// Hashes: XXH64 of bytes (Collet, xxHash specification 0.1.1, 2018) and a mixing function of 64 bits.
/// Neither is cryptographic.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace stillpoint {

/// XXH64 of `bytes`.
/// @param bytes any content
/// @param seed hash of the preceding content, to chain several contents
[[nodiscard]] std::uint64_t content_hash(std::string_view bytes, std::uint64_t seed = 0);

/// Sixteen hexadecimal digits.
[[nodiscard]] std::string hash_text(std::uint64_t hash);

/// Finalizer of SplitMix64 (Steele, Lea, Flood 2014): a bijection whose output bits look independent. For
/// random numbers that are a function of key and counter only.
[[nodiscard]] constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

}  // namespace stillpoint
