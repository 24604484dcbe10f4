// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/commit_history.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/analysis/run_groups.h"
#include "core/base/error.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

std::map<std::string, std::set<std::string>> plans_by_run(const Store& store,
                                                          const std::vector<StoredRun>& runs) {
  std::map<std::string, std::set<std::string>> plans;
  const std::vector<StoredPlan> stored = store.plans();
  if (stored.empty()) return plans;
  std::unordered_map<std::string, std::string> planned;
  for (const StoredRun& run : runs) planned[run.key] = planned_key(run.identity);
  for (const StoredPlan& plan : stored) {
    for (const std::string& key : plan.run_keys) {
      if (const auto found = planned.find(key); found != planned.end())
        plans[found->second].insert(plan.name);
    }
  }
  return plans;
}

/// Commits are numbered in the order of their first runs: of 10^5 runs, their names are most of the memory.
using CommitId = std::size_t;

/// Values of one series.
struct SeriesValues {
  std::string unit;
  const MetricDescriptor* gated = nullptr;
  std::set<std::string> plans;
  std::vector<std::pair<CommitId, double>> values;
};

using ValuesByCommit = std::map<CommitId, std::vector<double>>;

ValuesByCommit by_commit(const SeriesValues& collected) {
  ValuesByCommit values;
  for (const auto& [commit, value] : collected.values) values[commit].push_back(value);
  return values;
}

struct CommitTime {
  std::string name;
  std::string committed;
  std::string first_run;
  std::int64_t first_id = 0;
};

/// Builds the history incrementally from runs.
class HistoryBuilder {
 public:
  explicit HistoryBuilder(std::map<std::string, std::set<std::string>> plans) : plans_(std::move(plans)) {}

  void add(const StoredRun& run, const RunOrigin& origin) {
    const CommitId commit = noted(run, origin);
    const RunIdentity& identity = run.identity;
    const HistorySubject subject{identity.sequence,    identity.variant, identity.axis,  identity.axis_value,
                                 identity.mode,        identity.kind,    identity.cores, identity.seed,
                                 identity.sequence_id, origin.host};
    const auto plans = plans_.empty() ? plans_.end() : plans_.find(planned_key(identity));
    const auto value = [&](const std::string& metric, const std::string& unit, const MetricDescriptor* gated,
                           double number) {
      if (!std::isfinite(number)) return;
      SeriesValues& collected = series_[{subject, metric}];
      collected.unit = unit;
      collected.gated = gated;
      collected.values.emplace_back(commit, number);
      if (plans != plans_.end()) collected.plans.insert(plans->second.begin(), plans->second.end());
    };
    const bool is_ok = run.outcome == Outcome::kOk;
    succeeded_[subject][commit] += is_ok ? 1 : 0;
    value(std::string(metric_id::kFailedRuns), "", gated_metric(metric_id::kFailedRuns), is_ok ? 0.0 : 1.0);
    if (!is_ok) return;
    for (const Metric& metric : run.metrics)
      value(metric.name, metric.unit, gated_metric(without_protocol(metric.name)), metric.value);
    for (const ModuleCost& cost : run.costs)
      value(cost.module, "ms", gated_metric(metric_id::kModuleTime), cost.mean_ms);
  }

  [[nodiscard]] CommitHistory build() const {
    const std::vector<CommitId> order = commit_order();
    CommitHistory history;
    std::vector<std::size_t> index(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const CommitTime& time = times_[order[i]];
      history.commits.push_back({time.name, time.committed.empty() ? time.first_run : time.committed});
      index[order[i]] = i;
    }
    for (const auto& [key, collected] : series_) {
      HistorySeries series = series_of(key, collected, with_missing(key, collected), index);
      if (!series.commits.empty()) history.series.push_back(std::move(series));
    }
    return history;
  }

 private:
  using Key = std::pair<HistorySubject, std::string>;

  /// The number of the commit of a run, whose times are noted.
  CommitId noted(const StoredRun& run, const RunOrigin& origin) {
    const auto [entry, is_new] = ids_.insert({origin.commit, times_.size()});
    if (is_new) times_.push_back({origin.commit, origin.time, run.started, run.id});
    CommitTime& time = times_[entry->second];
    if (time.committed.empty()) time.committed = origin.time;
    if (run.started < time.first_run) {
      time.first_run = run.started;
      time.first_id = run.id;
    }
    return entry->second;
  }

  [[nodiscard]] std::vector<CommitId> commit_order() const {
    std::vector<std::tuple<std::string, std::string, std::int64_t, std::string, CommitId>> order;
    for (CommitId id = 0; id < times_.size(); ++id) {
      const CommitTime& time = times_[id];
      order.emplace_back(time.committed.empty() ? time.first_run : time.committed, time.first_run,
                         time.first_id, time.name, id);
    }
    std::sort(order.begin(), order.end());
    std::vector<CommitId> ids;
    ids.reserve(order.size());
    for (const auto& commit : order) ids.push_back(std::get<CommitId>(commit));
    return ids;
  }

  /// Successful runs without a finite value count as worse than any number. The median is then infinite if
  /// they are the majority: the commit has no value.
  [[nodiscard]] ValuesByCommit with_missing(const Key& key, const SeriesValues& collected) const {
    const auto& [subject, metric] = key;
    const MetricDescriptor* gated = collected.gated;
    ValuesByCommit all = by_commit(collected);
    if (gated == nullptr || gated->gate->absent_is_good || metric == metric_id::kFailedRuns) return all;
    const double worst = gated->direction == MetricDirection::kLargerIsBetter
                             ? -std::numeric_limits<double>::infinity()
                             : std::numeric_limits<double>::infinity();
    const std::map<CommitId, std::size_t>& counts = succeeded_.at(subject);
    for (auto& [commit, values] : all) values.resize(counts.at(commit), worst);
    std::erase_if(all,
                  [](const auto& entry) { return !std::isfinite(*eval::percentile(entry.second, 0.5)); });
    return all;
  }

  /// @param index position of each commit in the history
  static HistorySeries series_of(const Key& key, const SeriesValues& collected, const ValuesByCommit& all,
                                 const std::vector<std::size_t>& index) {
    HistorySeries series{.subject = key.first,
                         .plans = {collected.plans.begin(), collected.plans.end()},
                         .metric = key.second,
                         .unit = collected.unit,
                         .gated = collected.gated};
    std::vector<std::pair<std::size_t, const std::vector<double>*>> ordered;
    for (const auto& [commit, values] : all) ordered.emplace_back(index[commit], &values);
    std::sort(ordered.begin(), ordered.end());
    for (const auto& [commit, values] : ordered) {
      series.commits.push_back(commit);
      const auto mean = [](const std::vector<double>& v) { return eval::statistics(v)->mean; };
      series.values.push_back(series.metric == metric_id::kFailedRuns ? mean(*values)
                                                                      : *eval::percentile(*values, 0.5));
      series.runs.push_back(values->size());
    }
    return series;
  }

  std::map<std::string, std::set<std::string>> plans_;
  std::map<Key, SeriesValues> series_;
  std::map<HistorySubject, std::map<CommitId, std::size_t>> succeeded_;  // runs by commit
  std::map<std::string, CommitId> ids_;
  std::vector<CommitTime> times_;  // by id
};

}  // namespace

namespace {

std::string chosen_system(const Store& store, const std::string& name) {
  const std::vector<std::string> systems = systems_of(store);
  const bool is_known = std::ranges::find(systems, name.empty() ? kOwnSystem : name) != systems.end();
  if (is_known && !name.empty()) return name;
  if (name.empty()) return !is_known && systems.size() == 1 ? systems.front() : kOwnSystem;
  throw InputError("--system", fmt::format("the store has no run of \"{}\"; it has those of: {}", name,
                                           fmt::join(systems, ", ")));
}

}  // namespace

std::vector<std::string> systems_of(const Store& store) {
  std::set<std::string> systems;
  for (const StoredRun& run : store.run_headers()) systems.insert(run.identity.system);
  return {systems.begin(), systems.end()};
}

CommitHistory commit_history(const Store& store, const std::string& system) {
  constexpr std::size_t kChunk = 5000;  // runs whose details are in memory
  const std::string chosen = chosen_system(store, system);
  std::vector<StoredRun> runs = store.run_headers({.system = chosen});
  HistoryBuilder builder(plans_by_run(store, runs));
  const RunOrigins origins = run_origins(store, runs);
  for (std::size_t begin = 0; begin < runs.size(); begin += kChunk) {
    const auto first = runs.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = first + static_cast<std::ptrdiff_t>(std::min(kChunk, runs.size() - begin));
    const std::vector<StoredRun> chunk =
        store.with_details({std::make_move_iterator(first), std::make_move_iterator(last)});
    for (std::size_t i = 0; i < chunk.size(); ++i) builder.add(chunk[i], origins[begin + i]);
  }
  CommitHistory history = builder.build();
  history.system = chosen;
  return history;
}

std::size_t find_commit(const CommitHistory& history, const std::string& name) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < history.commits.size(); ++i) {
    if (history.commits[i].name == name) return i;
    if (!name.empty() && history.commits[i].name.starts_with(name)) found.push_back(i);
  }
  if (found.size() == 1) return found.front();
  const std::string newest = history.commits.empty() ? "none" : history.commits.back().name;
  throw InputError("commit \"" + name + "\"",
                   found.empty() ? "has no run in the store; the newest commit with a run is " + newest
                                 : "is ambiguous: several commits have this prefix; use a longer one");
}

}  // namespace stillpoint::bench
