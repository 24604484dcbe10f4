// SPDX-License-Identifier: BSD-3-Clause
/// Ablation heat map: relative change of each variant against its base per sequence, as a colored HTML table.
#pragma once

#include <string>
#include <vector>

#include "bench/model/metrics.h"

namespace stillpoint::report {

/// Variants of a plan that are compared with one base.
struct PlanAblation {
  std::string plan;
  std::string base;
  bool is_base_of_plan = true;         ///< false: a variant of the plan that the other variants extend
  std::vector<bench::StoredRun> runs;  ///< of the base and of these variants, outside sweeps
};

/// Relative changes of a metric with their number of pairs and intervals, paired by sequence and seed; warm
/// colors are worse, and only changes that `eval::is_significant` accepts are drawn without hatching.
/// @param metric smaller values are better
/// @return empty if no pair has the metric
[[nodiscard]] std::string heat_map_html(const PlanAblation& ablation, const bench::MetricDescriptor& metric);

}  // namespace stillpoint::report
