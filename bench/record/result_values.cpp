// SPDX-License-Identifier: BSD-3-Clause
#include "bench/record/result_values.h"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/json_problem.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Counts are integers in JSON.
Json number(const MetricDescriptor& metric, const std::optional<double>& value) {
  if (!value) return nullptr;
  return metric.decimals == 0 ? Json(std::llround(*value)) : Json(*value);
}

Json protocols_json() {
  Json protocols = Json::object();
  for (const MetricDescriptor* metric : metrics_of(MetricSource::kTrajectory)) {
    if (!metric->protocol.key.empty())
      protocols[std::string(metric->protocol.key)] = std::string(metric->protocol.text);
  }
  return protocols;
}

/// @param per unit of the statistics
std::vector<ModuleCost> costs_of(const Json& timings, const char* group, const char* per) {
  std::vector<ModuleCost> costs;
  if (!timings.contains(group)) return costs;
  for (const auto& [module, time] : timings.at(group).items()) {
    costs.push_back({.module = module,
                     .per = per,
                     .calls = time.at("calls").get<std::int64_t>(),
                     .mean_ms = time.at("mean").get<double>(),
                     .median_ms = time.at("median").get<double>(),
                     .p95_ms = time.at("p95").get<double>(),
                     .max_ms = time.at("max").get<double>()});
  }
  return costs;
}

}  // namespace

Json number_or_null(const std::optional<double>& number) { return number ? Json(*number) : Json(nullptr); }

Json metric_members(const Measurements& measurements) {
  Json json;
  for (const MetricDescriptor& metric : all_metrics()) {
    const bool is_measured = (metric.source == MetricSource::kTrajectory && measurements.scored) ||
                             (metric.source == MetricSource::kRun && measurements.counts) ||
                             (metric.source == MetricSource::kHonesty && measurements.honesty) ||
                             (metric.source == MetricSource::kLoop && measurements.loops) ||
                             (metric.source == MetricSource::kDevice && measurements.device) ||
                             (metric.source == MetricSource::kImuRate && measurements.imu_rate);
    if (is_measured) json[std::string(metric.id)] = number(metric, metric.value(measurements));
  }
  if (!measurements.scored) return json;
  const eval::Score& score = measurements.scored->score;
  json["ate_pairs"] = score.ate ? score.ate->pairs : 0;
  json["protocols"] = protocols_json();
  return json;
}

std::string score_text(const Measurements& measurements) {
  std::string text;
  for (const MetricDescriptor* metric : metrics_of(MetricSource::kTrajectory)) {
    const std::optional<double> value = metric->value(measurements);
    text += fmt::format(
        "{:<13} {}\n", metric->label,
        value ? fmt::format("{:.{}f} {}", *value, metric->decimals == 0 ? 0 : 6, metric->unit) : "n/a");
  }
  return text;
}

std::vector<Metric> stored_metrics(const Json& result) {
  std::vector<Metric> metrics;
  const Json protocols = result.value("protocols", Json::object());
  for (const MetricDescriptor& metric : all_metrics()) {
    const auto found = result.find(metric.id);
    if (found == result.end() || !found->is_number()) continue;
    metrics.push_back({.name = std::string(metric.id),
                       .protocol = protocols.value(std::string(metric.protocol.key), ""),
                       .unit = std::string(metric.unit),
                       .value = found->get<double>()});
  }
  return metrics;
}

std::vector<ModuleCost> module_costs(const Json& timings) {
  std::vector<ModuleCost> costs = costs_of(timings, "modules", "call");
  const std::vector<ModuleCost> threads = costs_of(timings, "threads", "frame");
  costs.insert(costs.end(), threads.begin(), threads.end());
  return costs;
}

std::optional<Eigen::Quaterniond> read_leveling_rotation(const std::filesystem::path& result_json) {
  constexpr const char* kMember = "leveling_rotation_xyzw";
  constexpr double kTolerance = 1e-6;  // of the norm
  try {
    const auto json = nlohmann::json::parse(eval::read_text_file(result_json));
    if (!json.contains(kMember)) return std::nullopt;
    const auto values = json.at(kMember).get<std::array<double, 4>>();
    const Eigen::Quaterniond q(values[3], values[0], values[1], values[2]);
    if (std::abs(q.norm() - 1.0) < kTolerance) return q.normalized();
  } catch (const nlohmann::json::exception& error) {
    throw InputError(result_json.string(), "is not a result file: " + json_problem(error));
  }
  throw InputError(result_json.string(), std::string(kMember) + " is no unit quaternion x, y, z, w");
}

}  // namespace stillpoint::bench
