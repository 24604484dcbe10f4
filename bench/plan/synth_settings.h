// SPDX-License-Identifier: BSD-3-Clause
/// Sets numeric fields of a rendering request by their names.
#pragma once

#include <string>
#include <string_view>

#include "datasets/synthetic/sequence/presets.h"

namespace stillpoint::bench {

/// Beginning of the keys of plans that belong to a rendering request.
inline constexpr std::string_view kSynthPrefix = "synth.";

/// Returns the request with one numeric field changed.
/// @param key dotted, e.g. "walkers", "depth.noise_per_m", "imu.gyro_bias"
/// @throws InputError for an unknown key (with the nearest one), for a fraction if the field is an integer,
/// and for a value out of range
[[nodiscard]] synth::SynthRequest with_number(synth::SynthRequest request, const std::string& key,
                                              double value);

}  // namespace stillpoint::bench
