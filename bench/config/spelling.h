// SPDX-License-Identifier: BSD-3-Clause
/// Suggests the nearest valid name for a mistyped one.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace stillpoint::bench {

/// Asymmetric edit distance from a typed text to a name: a wrong or additional letter costs 1, two swapped
/// neighbors 0.2, an omitted letter 0.1, so that abbreviations (`mcc`) and keys without their section
/// (`usage`) match the full name.
[[nodiscard]] double spelling_distance(std::string_view typed, std::string_view name);

/// `; did you mean "..."?` with the nearest of `names`; empty if none of them resembles the typed text, i.e.
/// more than half of its letters are wrong, and for paths of files ("/data", "./data").
[[nodiscard]] std::string suggestion(std::string_view typed, std::span<const std::string> names);

}  // namespace stillpoint::bench
