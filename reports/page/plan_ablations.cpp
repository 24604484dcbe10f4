// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page/plan_ablations.h"

#include <algorithm>
#include <set>

#include "bench/plan/bench_plan.h"
#include "reports/tables/run_cells.h"

namespace stillpoint::report {
namespace {

/// Runs of this odometry in a plan, outside sweeps.
std::vector<bench::StoredRun> own_runs(const bench::StoredPlan& plan,
                                       std::span<const bench::StoredRun> runs) {
  const std::set<std::string> keys(plan.run_keys.begin(), plan.run_keys.end());
  std::vector<bench::StoredRun> own;
  std::copy_if(runs.begin(), runs.end(), std::back_inserter(own), [&](const bench::StoredRun& run) {
    return run.identity.system == "stillpoint" && run.identity.axis.empty() && keys.contains(run.key);
  });
  return own;
}

std::vector<bench::StoredRun> runs_in(const std::vector<bench::StoredRun>& runs,
                                      const bench::AblationGroup& group) {
  std::vector<bench::StoredRun> found;
  std::copy_if(runs.begin(), runs.end(), std::back_inserter(found), [&](const bench::StoredRun& run) {
    const std::string& variant = run.identity.variant;
    return variant == group.base ||
           std::find(group.variants.begin(), group.variants.end(), variant) != group.variants.end();
  });
  return found;
}

std::string missing_reason(const std::vector<std::string>& variants, const std::string& base) {
  if (variants.empty()) return "it has no run of stillpoint outside sweeps";
  if (std::find(variants.begin(), variants.end(), base) == variants.end())
    return "its base " + base + " has no run on this page";
  return "only its base " + base + " was run";
}

}  // namespace

PlanAblations plan_ablations(std::span<const bench::StoredPlan> plans,
                             std::span<const bench::StoredRun> runs) {
  PlanAblations result;
  if (plans.empty())
    result.missing = {
        "There is no ablation, because the runs belong to no plan that names a base variant; "
        "`stillpoint stats ablation --base VARIANT` compares with any variant."};
  for (const bench::StoredPlan& plan : plans) {
    const std::string start = "Plan " + plan.name + " has no ablation: ";
    const std::optional<std::string> base = bench::ablation_base_of(plan);
    if (!base) {
      result.missing.push_back(start + "its stored text names no base variant (key ablation_base).");
      continue;
    }
    const std::vector<bench::StoredRun> own = own_runs(plan, runs);
    const std::vector<std::string> variants = distinct(own, system_label);
    const std::vector<bench::AblationGroup> groups = bench::ablation_groups(*base, variants);
    if (groups.empty()) result.missing.push_back(start + missing_reason(variants, *base) + ".");
    for (const bench::AblationGroup& group : groups) {
      result.ablations.push_back({.plan = plan.name,
                                  .base = group.base,
                                  .is_base_of_plan = group.base == *base,
                                  .runs = runs_in(own, group)});
    }
  }
  return result;
}

}  // namespace stillpoint::report
