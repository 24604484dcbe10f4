// SPDX-License-Identifier: BSD-3-Clause
/// Scores as plain text and as JSON.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "eval/score.h"

namespace stillpoint::bench {

/// One line per metric with its unit; "n/a" without data.
[[nodiscard]] std::string score_text(const eval::Score& score);

/// A JSON document; metrics without data are null.
[[nodiscard]] std::string score_json(const eval::Score& score);

/// The members of that document: metrics, and "protocols" by metric.
[[nodiscard]] nlohmann::ordered_json score_members(const eval::Score& score);

}  // namespace stillpoint::bench
