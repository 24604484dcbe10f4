// SPDX-License-Identifier: BSD-3-Clause
/// Type-erased references to all leaf members of a config struct; see core/base/fields.h.
///
/// A TOML file as a flat list of dotted keys with their values and source locations.
///
/// Applies settings from files and command lines to a config struct.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/fields.h"

namespace stillpoint::bench {

/// Reference to an enum member.
struct EnumField {
  void* member;
  std::vector<std::string_view> names;     ///< in configuration files
  std::size_t (*get)(const void* member);  ///< index into `names`
  void (*set)(void* member, std::size_t index);
};

/// Reference to one leaf member of a config struct.
struct ConfigField {
  std::string key;  ///< dotted, e.g. "frontend.grid.rows"
  FieldInfo info;   ///< without a text for the fields of plans, systems and devices
  std::variant<bool*, int*, double*, std::string*, std::vector<std::string>*, std::vector<int>*, EnumField>
      member;
};

template <class Enum>
[[nodiscard]] EnumField enum_field(Enum& member) {
  EnumField field{
      .member = &member,
      .names = {},
      .get =
          [](const void* value) {
            const auto names = enum_names(Enum{});
            std::size_t index = 0;
            while (names[index].first != *static_cast<const Enum*>(value)) ++index;
            return index;
          },
      .set = [](void* value,
                std::size_t index) { *static_cast<Enum*>(value) = enum_names(Enum{})[index].first; }};
  for (const auto& [value, name] : enum_names(Enum{})) field.names.push_back(name);
  return field;
}

template <class T>
concept ConfigSection = std::is_class_v<T> && !std::is_same_v<T, std::string> &&
                        !std::is_same_v<T, std::vector<std::string>> && !std::is_same_v<T, std::vector<int>>;

/// The meaning of a field by the arguments that follow it in a field list: nothing, its bounds, or all of it.
constexpr FieldInfo field_info() { return {}; }
constexpr FieldInfo field_info(const FieldInfo& info) { return info; }
constexpr FieldInfo field_info(double min, double max) { return {.text = {}, .min = min, .max = max}; }

/// All members that are not sections, in the order of the field lists. Valid while `config` exists.
template <class Config>
[[nodiscard]] std::vector<ConfigField> fields_of(Config& config, const std::string& prefix = "") {
  std::vector<ConfigField> fields;
  visit_fields(
      [&](std::string_view name, auto& member, const auto&... info) {
        using Member = std::remove_reference_t<decltype(member)>;
        const std::string key = prefix + std::string(name);
        if constexpr (ConfigSection<Member>) {
          for (ConfigField& field : fields_of(member, key + ".")) fields.push_back(std::move(field));
        } else if constexpr (std::is_enum_v<Member>) {
          fields.push_back({key, field_info(info...), enum_field(member)});
        } else {
          fields.push_back({key, field_info(info...), &member});
        }
      },
      config);
  return fields;
}

using SettingValue =
    std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>, std::vector<double>>;

/// One `key = value`, and its source location.
struct Setting {
  std::string key;  ///< dotted, e.g. "frontend.grid.rows"
  SettingValue value;
  std::string file;      ///< path or option, as shown in messages
  long line = 0;         ///< from 1; 0 for the command line
  bool shipped = false;  ///< by an embedded config, not by the user
};

/// Parses a TOML text into settings, in the order of its lines.
/// @param file name of the text in messages
/// @throws InputError if the text is not valid TOML, or a value is not a bool, number, string, or list of
/// strings or of numbers
[[nodiscard]] std::vector<Setting> parse_settings(std::string_view text, const std::string& file);

/// Parses a `key=value` argument of the command line; a value that is not valid TOML is read as a string.
/// @throws InputError if there is no key or no `=`
[[nodiscard]] Setting parse_assignment(const std::string& assignment);

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
