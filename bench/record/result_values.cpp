// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/result_values.h"

#include <nlohmann/json.hpp>

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;

/// A metric of result.json, its unit, and its key in "protocols".
struct MetricField {
  const char* key;
  const char* unit;
  const char* protocol;
};
constexpr MetricField kNumbers[] = {{"ate_rmse_m", "m", "ate"},
                                    {"rpe_trans_rmse_m_per_s", "m/s", "rpe"},
                                    {"rpe_rot_rmse_deg_per_s", "deg/s", "rpe"},
                                    {"correct_rate", "", "correct_rate"},
                                    {"coverage", "", "coverage"},
                                    {"first_pose_s", "s", ""},
                                    {"frames", "", ""},
                                    {"poses", "", ""},
                                    {"resets", "", ""},
                                    {"wall_s", "s", ""}};

void append_costs(std::vector<ModuleCost>& costs, const Json& timings, const char* group, const char* per) {
  if (!timings.contains(group)) return;
  for (const auto& [module, time] : timings.at(group).items()) {
    costs.push_back({.module = module,
                     .per = per,
                     .calls = time.at("calls").get<std::int64_t>(),
                     .mean_ms = time.at("mean").get<double>(),
                     .median_ms = time.at("median").get<double>(),
                     .p95_ms = time.at("p95").get<double>(),
                     .max_ms = time.at("max").get<double>()});
  }
}

}  // namespace

std::vector<Metric> score_metrics(const Json& json) {
  std::vector<Metric> metrics;
  const Json protocols = json.value("protocols", Json::object());
  for (const MetricField& number : kNumbers) {
    const auto found = json.find(number.key);
    if (found == json.end() || !found->is_number()) continue;
    metrics.push_back({.name = number.key,
                       .protocol = protocols.value(number.protocol, ""),
                       .unit = number.unit,
                       .value = found->get<double>()});
  }
  return metrics;
}

std::vector<ModuleCost> module_costs(const Json& timings) {
  std::vector<ModuleCost> costs;
  append_costs(costs, timings, "modules", "call");
  append_costs(costs, timings, "threads", "frame");
  return costs;
}

}  // namespace stillpoint::bench
