// SPDX-License-Identifier: BSD-3-Clause
/// Identity of a config in stores and manifests.
#pragma once

#include <string>

#include "core/config/odometry_config.h"

namespace stillpoint::bench {

/// Hash of all values of the config, as 16 hexadecimal digits; with a perturbed input, its seed follows (see
/// bench/model/stored_run.h).
[[nodiscard]] std::string config_hash(const OdometryConfig& config);

}  // namespace stillpoint::bench
