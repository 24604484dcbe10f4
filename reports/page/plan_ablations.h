// SPDX-License-Identifier: BSD-3-Clause
/// The ablations of the plans of a page, each with the base that its plan names, and their heat map: the
/// relative change of each variant against its base per sequence, as a colored HTML table.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/model/metrics.h"
#include "bench/store/store.h"

namespace stillpoint::report {

/// Variants of a plan that are compared with one base.
struct PlanAblation {
  std::string plan;
  std::string base;
  bool is_base_of_plan = true;         ///< false: a variant of the plan that the other variants extend
  std::vector<bench::StoredRun> runs;  ///< of the base and of these variants, outside sweeps
};

/// The ablations of all plans of a page.
struct PlanAblations {
  std::vector<PlanAblation> ablations;  ///< in the order of the plans
  std::vector<std::string> missing;     ///< one sentence for each plan without an ablation: the reason
};

/// @param runs of the plans, with the names of variants and sequences that the plans use
[[nodiscard]] PlanAblations plan_ablations(std::span<const bench::StoredPlan> plans,
                                           std::span<const bench::StoredRun> runs);

/// A table of the relative changes of a metric with their number of pairs and intervals, paired by sequence
/// and seed; warm colors are worse, and only changes that `eval::is_significant` accepts are drawn without
/// hatching.
/// @param metric smaller values are better
/// @return empty if no pair has the metric
[[nodiscard]] std::string heat_map_html(const PlanAblation& ablation, const bench::MetricDescriptor& metric);

}  // namespace stillpoint::report
