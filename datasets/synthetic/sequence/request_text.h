// SPDX-License-Identifier: BSD-3-Clause
/// Text form of a request: written next to the sequence, and hashed for the cache key.
#pragma once

#include <string>

#include "datasets/synthetic/sequence/presets.h"

namespace stillpoint::synth {

/// Incremented whenever the output for an unchanged request changes.
inline constexpr int kRendererVersion = 7;

/// The renderer version and every field of the request, one TOML line each.
[[nodiscard]] std::string request_text(const SynthRequest& request);

/// Cache key: 64-bit FNV-1a hash of the text and of the contents of the referenced files, as 16 hexadecimal
/// digits.
/// @throws InputError if one of those files cannot be read
[[nodiscard]] std::string request_key(const SynthRequest& request);

}  // namespace stillpoint::synth
