// SPDX-License-Identifier: BSD-3-Clause
/// A TOML file as a flat list of dotted keys with their values and source locations.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace stillpoint::bench {

using SettingValue =
    std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>, std::vector<double>>;

/// One `key = value`, and its source location.
struct Setting {
  std::string key;  ///< dotted, e.g. "frontend.grid.rows"
  SettingValue value;
  std::string file;  ///< path or option, as shown in messages
  long line = 0;     ///< from 1; 0 for the command line
};

/// Parses a TOML text into settings, in the order of its lines.
/// @param file name of the text in messages
/// @throws InputError if the text is not valid TOML, or a value is not a bool, number, string, or list of
/// strings or of numbers
[[nodiscard]] std::vector<Setting> parse_settings(std::string_view text, const std::string& file);

/// Parses a `key=value` argument of the command line; a value that is not valid TOML is read as a string.
/// @throws InputError if there is no key or no `=`
[[nodiscard]] Setting parse_assignment(const std::string& assignment);

}  // namespace stillpoint::bench
