// SPDX-License-Identifier: BSD-3-Clause
/// Changes a config by settings from files and command lines.
#pragma once

#include <span>

#include "bench/config/setting.h"
#include "core/pipeline/odometry_config.h"

namespace stillpoint {

/// The config with the settings applied in order; later ones win.
/// @throws InputError with file, line and the nearest key for an unknown key, a wrong type, or a value out of
/// range
[[nodiscard]] OdometryConfig with_settings(OdometryConfig config, std::span<const Setting> settings);

}  // namespace stillpoint
