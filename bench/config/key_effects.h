// SPDX-License-Identifier: BSD-3-Clause
/// Conditions without which keys have no effect, e.g. those of a loop without loop closure.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/odometry_config.h"

namespace stillpoint::bench {

/// Keys that begin with `prefix` have an effect only if the condition holds.
struct KeyCondition {
  std::string_view prefix;
  std::string_view requirement;  ///< in words of the config, e.g. "loop.enabled = true"
  bool (*holds)(const OdometryConfig&);
};

/// All conditions. Several may apply to one key. Prefixes that name no key are an error of a test.
[[nodiscard]] std::span<const KeyCondition> key_conditions();

/// What a key requires to have an effect in this config; empty if it has one.
[[nodiscard]] std::string_view missing_requirement(std::string_view key, const OdometryConfig& config);

}  // namespace stillpoint::bench
