// SPDX-License-Identifier: BSD-3-Clause
/// A config as text: every key with its value, for people, for manifests, and for comparison.
#pragma once

#include <string>
#include <vector>

#include "core/pipeline/odometry_config.h"

namespace stillpoint {

/// One key and its value as TOML writes it.
struct ConfigEntry {
  std::string key;
  std::string value;
  friend bool operator==(const ConfigEntry&, const ConfigEntry&) = default;
};

/// Every key in the fixed order of the field lists; numbers read back to the same bits.
[[nodiscard]] std::vector<ConfigEntry> config_entries(const OdometryConfig& config);

/// The entries as a TOML text of dotted keys, one a line.
[[nodiscard]] std::string config_text(const OdometryConfig& config);

/// Sixteen hexadecimal digits that change with any value of the config.
[[nodiscard]] std::string config_hash(const OdometryConfig& config);

/// The entries of `changed` whose values differ from those of `parent`.
[[nodiscard]] std::vector<ConfigEntry> config_difference(const OdometryConfig& parent,
                                                         const OdometryConfig& changed);

/// The reference page of all keys: a Markdown table of key, type or choices, range and default.
[[nodiscard]] std::string config_reference();

}  // namespace stillpoint
