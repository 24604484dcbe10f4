// SPDX-License-Identifier: BSD-3-Clause
/// Visits all leaf members of a config struct with their dotted keys; see core/base/fields.h.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/base/fields.h"

namespace stillpoint::bench {

/// Inclusive range of a number.
struct Bounds {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

template <class T>
concept ConfigEnum = std::is_enum_v<T>;

template <class T>
concept ConfigSection = std::is_class_v<T> && !std::is_same_v<T, std::string> &&
                        !std::is_same_v<T, std::vector<std::string>> && !std::is_same_v<T, std::vector<int>>;

/// Calls `leaf(key, member, bounds)` for every member that is not a section, in the order of the field lists.
template <class Config, class Leaf>
void walk_fields(Config& config, Leaf&& leaf, const std::string& prefix = "") {
  visit_fields(
      [&](std::string_view name, auto& member, auto... bounds) {
        const std::string key = prefix + std::string(name);
        if constexpr (ConfigSection<std::remove_cvref_t<decltype(member)>>) {
          walk_fields(member, leaf, key + ".");
        } else {
          leaf(key, member, Bounds{static_cast<double>(bounds)...});
        }
      },
      config);
}

}  // namespace stillpoint::bench
