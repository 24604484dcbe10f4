// SPDX-License-Identifier: BSD-3-Clause
/// Type-erased references to all leaf members of a config struct; see core/base/fields.h.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/fields.h"

namespace stillpoint::bench {

/// Inclusive range of a number.
struct Bounds {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

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
  Bounds bounds;
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

/// All members that are not sections, in the order of the field lists. Valid while `config` exists.
template <class Config>
[[nodiscard]] std::vector<ConfigField> fields_of(Config& config, const std::string& prefix = "") {
  std::vector<ConfigField> fields;
  visit_fields(
      [&](std::string_view name, auto& member, auto... bounds) {
        using Member = std::remove_reference_t<decltype(member)>;
        const std::string key = prefix + std::string(name);
        if constexpr (ConfigSection<Member>) {
          for (ConfigField& field : fields_of(member, key + ".")) fields.push_back(std::move(field));
        } else if constexpr (std::is_enum_v<Member>) {
          fields.push_back({key, {}, enum_field(member)});
        } else {
          fields.push_back({key, Bounds{static_cast<double>(bounds)...}, &member});
        }
      },
      config);
  return fields;
}

}  // namespace stillpoint::bench
