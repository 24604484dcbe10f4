// SPDX-License-Identifier: BSD-3-Clause
/// Evaluations as JSON in full precision; null = no data.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "eval/openloris/benchmark.h"
#include "reports/text/evaluation_table.h"

namespace stillpoint::report {

/// All fields except the per-pose errors.
[[nodiscard]] nlohmann::ordered_json evaluation_json(const eval::Evaluation& evaluation);

[[nodiscard]] nlohmann::ordered_json comparison_json(const eval::Comparison& comparison);

/// system -> scene -> scores, including those of each sequence.
[[nodiscard]] nlohmann::ordered_json openloris_json(const eval::OpenlorisEvaluation& evaluation);

}  // namespace stillpoint::report
