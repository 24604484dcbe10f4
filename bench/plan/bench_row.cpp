// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/bench_row.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <unordered_map>

#include <fmt/format.h>

#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

/// The runs that a row aggregates.
struct Group {
  const PlannedRun* first = nullptr;
  std::vector<const StoredRun*> runs;
};

using GroupKey = std::tuple<std::string, std::string, std::string, double>;

/// Groups in the order of their first runs.
std::vector<Group> groups_of(const PlanMatrix& matrix,
                             const std::unordered_map<std::string, StoredRun>& stored) {
  std::vector<Group> groups;
  std::map<GroupKey, std::size_t> index;
  for (const PlannedRun& run : matrix.runs) {
    const RunIdentity& identity = run.identity;
    const GroupKey key{identity.sequence, identity.variant, identity.axis, identity.axis_value};
    const auto [entry, is_new] = index.insert({key, groups.size()});
    if (is_new) groups.push_back({.first = &run, .runs = {}});
    const auto found = stored.find(run_key(identity));
    if (found != stored.end()) groups[entry->second].runs.push_back(&found->second);
  }
  return groups;
}

std::optional<double> median_of(const std::vector<const StoredRun*>& runs, std::string_view metric) {
  std::vector<double> values;
  for (const StoredRun* run : runs) {
    if (const std::optional<double> value = metric_value(*run, metric)) values.push_back(*value);
  }
  return eval::percentile(values, 0.5);
}

std::optional<double> median_cost(const std::vector<const StoredRun*>& runs, std::string_view module) {
  std::vector<double> values;
  for (const StoredRun* run : runs) {
    for (const ModuleCost& cost : run->costs) {
      if (cost.module == module) values.push_back(cost.mean_ms);
    }
  }
  return eval::percentile(values, 0.5);
}

/// Sets status and reason of a row.
void set_status(BenchRow& row, const std::vector<const StoredRun*>& runs,
                const std::string& unavailable_reason) {
  row.status = !unavailable_reason.empty() ? "skipped" : runs.empty() ? "not run" : "ok";
  row.reason = unavailable_reason;
  for (const StoredRun* run : runs) {
    if (run->outcome != Outcome::kOk && row.reason.empty()) {
      row.status = outcome_name(run->outcome);
      row.reason = run->detail;
    }
  }
  const std::optional<double> load = median_of(runs, "other_load");
  if (row.reason.empty() && median_of(runs, "quiet") == 0.0 && load) {
    row.reason =
        fmt::format("the machine was not idle: other processes used {:.0f} % of the CPU", 100.0 * *load);
  }
}

BenchRow row_of(const Group& group, const std::string& unavailable_reason) {
  const RunIdentity& identity = group.first->identity;
  BenchRow row;
  row.sequence = identity.sequence;
  row.variant = identity.variant;
  if (!identity.axis.empty()) row.sweep = fmt::format("{} = {}", identity.axis, identity.axis_value);
  set_status(row, group.runs, unavailable_reason);
  std::vector<const StoredRun*> succeeded;
  std::copy_if(group.runs.begin(), group.runs.end(), std::back_inserter(succeeded),
               [](const StoredRun* run) { return run->outcome == Outcome::kOk; });
  row.runs = group.runs.size();
  row.succeeded_runs = succeeded.size();
  row.ate_rmse_m = median_of(succeeded, "ate_rmse_m");
  row.rpe_trans_rmse_m_per_s = median_of(succeeded, "rpe_trans_rmse_m_per_s");
  row.rpe_rot_rmse_deg_per_s = median_of(succeeded, "rpe_rot_rmse_deg_per_s");
  row.correct_rate = median_of(succeeded, "correct_rate");
  row.coverage = median_of(succeeded, "coverage");
  row.first_pose_s = median_of(succeeded, "first_pose_s");
  for (std::size_t i = 0; i < kModuleCount; ++i) {
    row.mean_ms[i] = median_cost(succeeded, module_name(static_cast<Module>(i)));
  }
  return row;
}

}  // namespace

std::vector<BenchRow> plan_rows(const PlanMatrix& matrix, const Store& store) {
  std::unordered_map<std::string, StoredRun> stored;
  for (StoredRun& run : store.runs()) stored[run.key] = std::move(run);
  std::vector<BenchRow> rows;
  for (const Group& group : groups_of(matrix, stored)) {
    rows.push_back(row_of(group, matrix.sequences[group.first->sequence].unavailable_reason));
  }
  return rows;
}

}  // namespace stillpoint::bench
