// SPDX-License-Identifier: BSD-3-Clause
/// Applies settings from files and command lines to a config struct.
#pragma once

#include <span>

#include "bench/config/config_fields.h"
#include "bench/config/setting.h"

namespace stillpoint::bench {

/// Assigns the settings to the members with their keys, in order; later ones override earlier ones.
/// @throws InputError with file and line for an unknown key (with the nearest key), a wrong type, or a value
/// out of range
void assign_settings(std::span<const ConfigField> fields, std::span<const Setting> settings);

/// Returns the struct with the settings applied, see `assign_settings`.
/// @tparam Config a struct with `visit_fields`, see core/base/fields.h
template <class Config>
[[nodiscard]] Config with_settings(Config config, std::span<const Setting> settings) {
  assign_settings(fields_of(config), settings);
  return config;
}

}  // namespace stillpoint::bench
