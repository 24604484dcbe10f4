// SPDX-License-Identifier: BSD-3-Clause
/// Values in result.json of a run, written and read back: metrics and module times, which are converted to
/// those of a store, and the rotation that levels the world of the run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include "bench/model/metrics.h"

namespace stillpoint::bench {

/// The number; null without one.
[[nodiscard]] nlohmann::ordered_json number_or_null(const std::optional<double>& number);

/// Members of result.json: each metric of the measured parts (null without data), the numbers of matched
/// pairs, and "protocols", how the metrics are evaluated.
[[nodiscard]] nlohmann::ordered_json metric_members(const Measurements& measurements);

/// The metrics of the trajectory as plain text, one line each, with unit; "n/a" without data.
[[nodiscard]] std::string score_text(const Measurements& measurements);

/// Metrics with unit and protocol; null values are skipped.
/// @param result with the members of `metric_members`; members of other versions that are not in the list of
///               metrics are skipped
[[nodiscard]] std::vector<Metric> stored_metrics(const nlohmann::ordered_json& result);

/// @param timings the member "timings" of a result file: "modules" and "threads", in ms
/// @throws nlohmann::json::exception if a member is missing or of another type
[[nodiscard]] std::vector<ModuleCost> module_costs(const nlohmann::ordered_json& timings);

/// Reads the member "leveling_rotation_xyzw".
/// @return nullopt if the file has no such member
/// @throws InputError if the file is no JSON object, or if the member is no rotation
[[nodiscard]] std::optional<Eigen::Quaterniond> read_leveling_rotation(
    const std::filesystem::path& result_json);

}  // namespace stillpoint::bench
