// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/metric_rules.h"

#include <algorithm>
#include <iterator>

namespace stillpoint::bench {
namespace {

// Accuracy margin: the smallest practically relevant change. Cost margin: the smallest change that ten to
// twenty pairs can resolve on a shared machine. Floor: the precision of the ground truth.
constexpr MetricRule kRules[] = {
    {"ate_rmse_m", MetricFamily::kAccuracy, false, 0.05, 2e-4},
    {"rpe_trans_rmse_m_per_s", MetricFamily::kAccuracy, false, 0.05, 2e-4},
    {"rpe_rot_rmse_deg_per_s", MetricFamily::kAccuracy, false, 0.05, 5e-3},
    {"correct_rate", MetricFamily::kAccuracy, true, 0.01, 0.0},
    {"coverage", MetricFamily::kAccuracy, true, 0.01, 0.0},
    {"ms", MetricFamily::kCost, false, 0.03, 0.01, false},
    {"process_cpu_s", MetricFamily::kCost, false, 0.03, 0.02, false},
    {"peak_memory_mb", MetricFamily::kCost, false, 0.05, 2.0, false},
    // Counted, not timed: no measurement noise, but they also change with the compiler or a library update.
    {"instructions", MetricFamily::kCost, false, 0.01, 0.0},
    {"instructions_tracking", MetricFamily::kCost, false, 0.01, 0.0},
    {"instructions_detection", MetricFamily::kCost, false, 0.01, 1e6},
    {"instructions_optimization", MetricFamily::kCost, false, 0.01, 0.0},
};

}  // namespace

std::optional<MetricRule> metric_rule(std::string_view name) {
  const auto* found = std::find_if(std::begin(kRules), std::end(kRules),
                                   [&](const MetricRule& rule) { return rule.name == name; });
  return found == std::end(kRules) ? std::nullopt : std::optional(*found);
}

}  // namespace stillpoint::bench
