// SPDX-License-Identifier: BSD-3-Clause
/// 64-bit hash of bytes: XXH64 (Collet, xxHash specification 0.1.1, 2018). Not cryptographic.
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

}  // namespace stillpoint
