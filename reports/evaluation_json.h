// SPDX-License-Identifier: BSD-3-Clause
/// Evaluations as JSON in full precision; null without data.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "eval/openloris/benchmark.h"
#include "reports/evaluation_table.h"

namespace stillpoint {

/// Everything but the per-pose errors.
[[nodiscard]] nlohmann::ordered_json evaluation_json(const Evaluation& evaluation);

[[nodiscard]] nlohmann::ordered_json comparison_json(const Comparison& comparison);

/// system -> scene -> scores, with every sequence below.
[[nodiscard]] nlohmann::ordered_json openloris_json(const OpenlorisEvaluation& evaluation);

}  // namespace stillpoint
