// SPDX-License-Identifier: BSD-3-Clause
/// Which numbers a comparison looks at, in which direction they are good, and which changes do not matter.
#pragma once

#include <optional>
#include <string_view>

namespace stillpoint {

enum class MetricFamily {
  kAccuracy,  ///< proven equal when trajectories are
  kCost,      ///< differs from run to run, always
};

struct MetricRule {
  std::string_view name;  ///< of a metric; a module's cost is "ms"
  MetricFamily family = MetricFamily::kAccuracy;
  bool larger_is_better = false;
  double margin = 0.0;     ///< a relative change below it does not matter
  double floor = 0.0;      ///< nor does an absolute one below this, in the metric's unit
  bool repeatable = true;  ///< the same program gives the same number each time
};

/// Nothing for a metric that comparisons leave out.
[[nodiscard]] std::optional<MetricRule> metric_rule(std::string_view name);

}  // namespace stillpoint
