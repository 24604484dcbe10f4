// SPDX-License-Identifier: BSD-3-Clause
/// Field enumeration of config structs: one list serves parsing, printing, hashing and the reference page.
///
/// Each struct defines, found by argument-dependent lookup,
///   template <class Visitor, class Config> void visit_fields(Visitor&& field, Config& config);
/// which calls `field(name, member)`, `field(name, member, min, max)` or `field(name, member,
/// FieldInfo{...})` in a fixed order. Members are bool, int, double, std::string, std::vector<std::string>,
/// an enum with `enum_names`, or another such struct (a TOML table). Bounds are inclusive.
#pragma once

#include <array>
#include <limits>
#include <string_view>
#include <utility>

namespace stillpoint {

/// What a key means, for `stillpoint config reference` and the readers of the field lists.
struct FieldInfo {
  std::string_view text;       ///< one sentence, with the origin of the default
  std::string_view unit = {};  ///< empty for a number without unit, a choice or a text
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::string_view paper =
      {};  ///< section of the paper, e.g. "III-D, Eq. (4)"; empty if it is not in the paper
};

/// The spelling of each enum value in configuration files. To support an enum E, define next to it
///   constexpr auto enum_names(E) { return EnumNames<E, 2>{{{E::kA, "a"}, {E::kB, "b"}}}; }
template <class Enum, std::size_t N>
using EnumNames = std::array<std::pair<Enum, std::string_view>, N>;

}  // namespace stillpoint
