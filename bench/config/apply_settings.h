// SPDX-License-Identifier: BSD-3-Clause
/// Changes a config, or a plan, by settings from files and command lines.
#pragma once

#include <span>

#include "bench/config/setting.h"

namespace stillpoint {

/// The struct with the settings applied in order; later ones win.
/// @throws InputError with file, line and the nearest key for an unknown key, a wrong type, or a value out of
/// range
/// @tparam Config OdometryConfig, BenchPlan, ExternalSystem or BoardFile
template <class Config>
[[nodiscard]] Config with_settings(Config config, std::span<const Setting> settings);

}  // namespace stillpoint
