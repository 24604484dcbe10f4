// SPDX-License-Identifier: BSD-3-Clause
/// Guesses what a mistyped name was meant to be.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace stillpoint {

/// Edit distance from what was typed to a name: a wrong or surplus letter costs 1, an omitted one 0.1, so
/// that abbreviations (`mcc`) and left-out sections (`usage`) find their long form.
[[nodiscard]] double spelling_distance(std::string_view typed, std::string_view name);

/// `; did you mean "..."?` with the nearest of `names`; empty if there is none.
[[nodiscard]] std::string suggestion(std::string_view typed, std::span<const std::string> names);

}  // namespace stillpoint
