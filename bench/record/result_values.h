// SPDX-License-Identifier: BSD-3-Clause
/// Conversion of result.json to the metrics and timings of a store.
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/model/stored_run.h"

namespace stillpoint::bench {

/// Scores and counts with unit and protocol; null values are skipped.
/// @param json with the members of `score_members` and, optionally, the other members of result.json
[[nodiscard]] std::vector<Metric> score_metrics(const nlohmann::ordered_json& json);

/// @param timings the member "timings" of a result file: "modules" and "threads", in ms
/// @throws nlohmann::json::exception if a member is missing or of another type
[[nodiscard]] std::vector<ModuleCost> module_costs(const nlohmann::ordered_json& timings);

}  // namespace stillpoint::bench
