// SPDX-License-Identifier: BSD-3-Clause
/// Metrics of a comparison, with their direction and smallest relevant change.
#pragma once

#include <optional>
#include <string_view>

namespace stillpoint::bench {

enum class MetricFamily {
  kAccuracy,  ///< equal if the trajectories are bit-equal
  kCost,      ///< varies between runs
};

struct MetricRule {
  std::string_view name;  ///< metric name; "ms" for the cost of a module
  MetricFamily family = MetricFamily::kAccuracy;
  bool larger_is_better = false;
  double margin = 0.0;     ///< smallest relevant relative change
  double floor = 0.0;      ///< smallest relevant absolute change, in the unit of the metric
  bool repeatable = true;  ///< the same program gives the same value in each run
};

/// Rule of a metric; nullopt if the metric is not compared.
[[nodiscard]] std::optional<MetricRule> metric_rule(std::string_view name);

}  // namespace stillpoint::bench
