// SPDX-License-Identifier: BSD-3-Clause
/// Changes numbers of a rendering by the names of their fields.
#pragma once

#include <string>

#include "datasets/synthetic/presets.h"

namespace stillpoint {

/// The request with one number changed.
/// @param key dotted, e.g. "walkers", "depth.noise_per_m", "imu.gyro_bias"
/// @throws InputError for a key that is no number of a rendering, with the nearest one, for a fraction where
/// a whole number is asked for, and for a value out of range
[[nodiscard]] SynthRequest with_number(SynthRequest request, const std::string& key, double value);

}  // namespace stillpoint
