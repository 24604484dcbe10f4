// SPDX-License-Identifier: BSD-3-Clause
/// Applies settings from files and command lines to a config struct.
#pragma once

#include <span>

#include "bench/config/setting.h"

namespace stillpoint::bench {

/// Returns the struct with the settings applied in order; later ones override earlier ones.
/// @throws InputError with file and line for an unknown key (with the nearest key), a wrong type, or a value
/// out of range
/// @tparam Config OdometryConfig, BenchPlan, ExternalSystem or DeviceFile
template <class Config>
[[nodiscard]] Config with_settings(Config config, std::span<const Setting> settings);

}  // namespace stillpoint::bench
