// SPDX-License-Identifier: BSD-3-Clause
/// A 64-bit fingerprint of bytes: XXH64 (Collet, xxHash specification 0.1.1, 2018). Not for secrets.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace stillpoint {

/// @param seed the hash of what came before, to chain several contents
[[nodiscard]] std::uint64_t content_hash(std::string_view bytes, std::uint64_t seed = 0);

/// Sixteen hexadecimal digits.
[[nodiscard]] std::string hash_text(std::uint64_t hash);

}  // namespace stillpoint
