// SPDX-License-Identifier: BSD-3-Clause
/// Options whose values are the names of an enum (`enum_names` of core/base/fields.h).
#pragma once

#include <string>

#include "core/base/error.h"
#include "core/base/fields.h"

namespace stillpoint::bench {

/// The accepted values, e.g. "none, first_pose, yaw".
template <class Enum>
[[nodiscard]] std::string enum_list() {
  std::string list;
  for (const auto& [value, name] : enum_names(Enum{})) list.append(list.empty() ? "" : ", ").append(name);
  return list;
}

/// The value with the given name.
/// @throws InputError naming the option and the accepted values
template <class Enum>
[[nodiscard]] Enum enum_of(const std::string& option, const std::string& name) {
  for (const auto& [value, known] : enum_names(Enum{})) {
    if (known == name) return value;
  }
  throw InputError(option, "unknown value \"" + name + "\"; expected one of: " + enum_list<Enum>());
}

}  // namespace stillpoint::bench
