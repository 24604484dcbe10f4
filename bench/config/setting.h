// SPDX-License-Identifier: BSD-3-Clause
/// What a TOML file says, taken apart into dotted keys with their values and places.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace stillpoint {

using SettingValue =
    std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>, std::vector<double>>;

/// One `key = value`, and where it was written.
struct Setting {
  std::string key;  ///< dotted, e.g. "frontend.grid.rows"
  SettingValue value;
  std::string file;  ///< as the user knows it
  long line = 0;     ///< from 1; 0 for a command line
};

/// Takes a TOML text apart, in the order of its lines.
/// @param file name of the text in messages
/// @throws InputError if the text is no TOML, or a value is neither bool, number, string nor list of strings
/// or of numbers
[[nodiscard]] std::vector<Setting> parse_settings(std::string_view text, const std::string& file);

/// Takes `key=value` from a command line apart; a value that is no TOML is taken as a bare string.
/// @throws InputError if there is no key or no `=`
[[nodiscard]] Setting parse_assignment(const std::string& assignment);

}  // namespace stillpoint
