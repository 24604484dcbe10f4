// SPDX-License-Identifier: BSD-3-Clause
/// Scores for people and for programs.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "eval/score.h"

namespace stillpoint {

/// One line a number with its unit; "n/a" without data.
[[nodiscard]] std::string score_text(const Score& score);

/// A JSON document; null without data.
[[nodiscard]] std::string score_json(const Score& score);

/// The members of that document, and the recipe of each number.
[[nodiscard]] nlohmann::ordered_json score_members(const Score& score);

}  // namespace stillpoint
