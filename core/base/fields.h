// SPDX-License-Identifier: BSD-3-Clause
/// How a config struct lists its fields once, for parsing, printing, hashing and the generated reference
/// page.
///
/// Each struct has, found by argument-dependent look-up,
///   template <class Visitor, class Config> void visit_fields(Visitor&& field, Config& config);
/// which calls `field(name, member)` or `field(name, member, min, max)` in a fixed order. Members are bool,
/// int, double, std::string, std::vector<std::string>, an enum with `enum_names`, or another such struct (a
/// TOML table). Bounds are inclusive.
#pragma once

#include <array>
#include <string_view>
#include <utility>

namespace stillpoint {

/// The spelling of each value of an enum in configuration files. An enum E takes part by defining, beside it,
///   constexpr auto enum_names(E) { return EnumNames<E, 2>{{{E::kA, "a"}, {E::kB, "b"}}}; }
template <class Enum, std::size_t N>
using EnumNames = std::array<std::pair<Enum, std::string_view>, N>;

}  // namespace stillpoint
