// SPDX-License-Identifier: BSD-3-Clause
/// A request as text: for the record beside a sequence, and as the key of the cache.
#pragma once

#include <string>

#include "datasets/synthetic/presets.h"

namespace stillpoint {

/// Raised whenever the same request gives other bits than before.
inline constexpr int kRendererVersion = 6;

/// Every field that decides about the sequence, a TOML line each, and the renderer's version.
[[nodiscard]] std::string request_text(const SynthRequest& request);

/// 16 hexadecimal digits of the text and of the contents of the files that the request names (FNV-1a, 64
/// bits).
/// @throws InputError if one of those files cannot be read
[[nodiscard]] std::string request_key(const SynthRequest& request);

}  // namespace stillpoint
