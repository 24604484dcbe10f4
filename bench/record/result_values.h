// SPDX-License-Identifier: BSD-3-Clause
/// The numbers of a result file as a store keeps them.
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/store/stored_run.h"

namespace stillpoint {

/// Scores and counts with unit and recipe; null ones are left out.
/// @param json with the members of `score_members`, and of a result file if there are more
[[nodiscard]] std::vector<Metric> score_metrics(const nlohmann::ordered_json& json);

/// @param timings the member "timings" of a result file: "modules" and "threads", in ms
/// @throws nlohmann::json::exception if it is anything else
[[nodiscard]] std::vector<ModuleCost> module_costs(const nlohmann::ordered_json& timings);

}  // namespace stillpoint
