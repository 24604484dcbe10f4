// SPDX-License-Identifier: BSD-3-Clause
/// The ablations of the plans of a page, each with the base that its plan names.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/store/store.h"
#include "reports/page/charts/heat_map.h"

namespace stillpoint::report {

struct PlanAblations {
  std::vector<PlanAblation> ablations;  ///< in the order of the plans
  std::vector<std::string> missing;     ///< one sentence for each plan without an ablation: the reason
};

/// @param runs of the plans, with the names of variants and sequences that the plans use
[[nodiscard]] PlanAblations plan_ablations(std::span<const bench::StoredPlan> plans,
                                           std::span<const bench::StoredRun> runs);

}  // namespace stillpoint::report
