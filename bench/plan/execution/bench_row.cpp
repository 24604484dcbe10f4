// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/bench_row.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <unordered_map>

#include <fmt/format.h>

#include "bench/model/metrics.h"
#include "bench/model/missing_boxes.h"
#include "bench/model/protocol_difference.h"
#include "bench/model/time_source.h"
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

/// A row with availability, outcome and reason.
BenchRow row_with_outcome(const std::vector<const StoredRun*>& runs, const std::string& unavailable_reason) {
  BenchRow row{.is_available = unavailable_reason.empty(), .reason = unavailable_reason};
  if (!runs.empty()) row.outcome = Outcome::kOk;
  for (const StoredRun* run : runs) {
    if (run->outcome != Outcome::kOk && row.reason.empty()) {
      row.outcome = run->outcome;
      row.reason = run->detail;
    }
  }
  if (row.reason.empty()) row.reason = missing_boxes_note(runs);
  const std::optional<double> load = median_of(runs, metric_id::kOtherLoad);
  if (row.reason.empty() && median_of(runs, metric_id::kQuiet) == 0.0 && load) {
    row.reason =
        fmt::format("the machine was not idle: other processes used {:.0f} % of the CPU", 100.0 * *load);
  }
  if (row.reason.empty()) row.reason = protocol_difference_note(runs, headline_metric().id);
  return row;
}

BenchRow row_of(const Group& group, const std::string& unavailable_reason) {
  const RunIdentity& identity = group.first->identity;
  BenchRow row = row_with_outcome(group.runs, unavailable_reason);
  row.sequence = identity.sequence;
  row.variant = identity.variant;
  if (!identity.axis.empty()) row.sweep = fmt::format("{} = {}", identity.axis, identity.axis_value);
  std::vector<const StoredRun*> succeeded;
  std::copy_if(group.runs.begin(), group.runs.end(), std::back_inserter(succeeded),
               [](const StoredRun* run) { return run->outcome == Outcome::kOk; });
  row.runs = group.runs.size();
  row.succeeded_runs = succeeded.size();
  for (const StoredRun* run : succeeded) row.time_source = std::max(row.time_source, time_source(*run));
  for (const MetricDescriptor* metric : metrics_of(MetricSource::kTrajectory)) {
    if (const std::optional<double> median = median_of(succeeded, metric->id))
      row.metrics[std::string(metric->id)] = *median;
  }
  for (std::size_t i = 0; i < kModuleCount; ++i) {
    row.mean_ms[i] = median_cost(succeeded, module_name(static_cast<Module>(i)));
  }
  return row;
}

}  // namespace

std::string row_status(const BenchRow& row) {
  if (!row.is_available) return "skipped";
  return row.outcome ? outcome_name(*row.outcome) : "not run";
}

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
