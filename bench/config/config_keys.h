// SPDX-License-Identifier: BSD-3-Clause
/// Keys of configs as tables: their meaning, and their differences between two configs. The texts of
/// config_file.h are made of them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/config/settings.h"
#include "core/config/odometry_config.h"

namespace stillpoint::bench {

/// A key whose values differ, in TOML syntax.
struct DifferentKey {
  std::string key, a, b, unit;
};

[[nodiscard]] std::vector<DifferentKey> different_keys(const OdometryConfig& a, const OdometryConfig& b);

/// The same for the fields of two structs of one type.
[[nodiscard]] std::vector<DifferentKey> different_keys(std::span<const ConfigField> a,
                                                       std::span<const ConfigField> b);

/// One key per line: `KEY = A -> B UNIT`. Empty if there are none.
[[nodiscard]] std::string difference_text(std::span<const DifferentKey> keys);

/// What a key means.
struct KeyReference {
  std::string key, meaning;
  std::string type;           ///< or the choices
  std::optional<double> min;  ///< of numbers
  std::optional<double> max;
  std::string unit;           ///< empty: none
  std::string default_value;  ///< in TOML syntax
  std::string paper;          ///< section; empty: not in the paper
};

[[nodiscard]] std::vector<KeyReference> key_references();

}  // namespace stillpoint::bench
