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

/// Values of one series, by commit name.
struct SeriesValues {
  std::string unit;
  const MetricDescriptor* gated = nullptr;
  std::set<std::string> plans;
  std::map<std::string, std::vector<double>> values;
};

struct CommitTime {
  std::string committed;
  std::string first_run;
  std::int64_t first_id = 0;
};

/// Builds the history incrementally from runs.
class HistoryBuilder {
 public:
  explicit HistoryBuilder(std::map<std::string, std::set<std::string>> plans) : plans_(std::move(plans)) {}

  void add(const StoredRun& run, const RunOrigin& origin) {
    note_time(run, origin);
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
      collected.values[origin.commit].push_back(number);
      if (plans != plans_.end()) collected.plans.insert(plans->second.begin(), plans->second.end());
    };
    const bool is_ok = run.outcome == Outcome::kOk;
    succeeded_[subject][origin.commit] += is_ok ? 1 : 0;
    value(std::string(metric_id::kFailedRuns), "", gated_metric(metric_id::kFailedRuns), is_ok ? 0.0 : 1.0);
    if (!is_ok) return;
    for (const Metric& metric : run.metrics)
      value(metric.name, metric.unit, gated_metric(without_protocol(metric.name)), metric.value);
    for (const ModuleCost& cost : run.costs)
      value(cost.module, "ms", gated_metric(metric_id::kModuleTime), cost.mean_ms);
  }

  [[nodiscard]] CommitHistory build() const {
    CommitHistory history{.commits = ordered_commits(), .series = {}};
    std::map<std::string, std::size_t> index;
    for (std::size_t i = 0; i < history.commits.size(); ++i) index[history.commits[i].name] = i;
    for (const auto& [key, collected] : series_) {
      HistorySeries series = series_of(key, with_missing(key, collected), index);
      if (!series.commits.empty()) history.series.push_back(std::move(series));
    }
    return history;
  }

 private:
  using Key = std::pair<HistorySubject, std::string>;

  void note_time(const StoredRun& run, const RunOrigin& origin) {
    const auto [entry, is_new] = times_.insert({origin.commit, {origin.time, run.started, run.id}});
    CommitTime& time = entry->second;
    if (time.committed.empty()) time.committed = origin.time;
    if (is_new || run.started >= time.first_run) return;
    time.first_run = run.started;
    time.first_id = run.id;
  }

  [[nodiscard]] std::vector<Commit> ordered_commits() const {
    std::vector<std::tuple<std::string, std::string, std::int64_t, std::string>> order;
    for (const auto& [name, time] : times_) {
      order.emplace_back(time.committed.empty() ? time.first_run : time.committed, time.first_run,
                         time.first_id, name);
    }
    std::sort(order.begin(), order.end());
    std::vector<Commit> commits;
    commits.reserve(order.size());
    for (const auto& [when, first_run, first_id, name] : order) commits.push_back({name, when});
    return commits;
  }

  /// Successful runs without a finite value count as worse than any number. The median is then infinite if
  /// they are the majority: the commit has no value.
  [[nodiscard]] SeriesValues with_missing(const Key& key, SeriesValues collected) const {
    const auto& [subject, metric] = key;
    const MetricDescriptor* gated = collected.gated;
    if (gated == nullptr || gated->gate->absent_is_good || metric == metric_id::kFailedRuns) return collected;
    const double worst = gated->direction == MetricDirection::kLargerIsBetter
                             ? -std::numeric_limits<double>::infinity()
                             : std::numeric_limits<double>::infinity();
    const std::map<std::string, std::size_t>& counts = succeeded_.at(subject);
    for (auto& [commit, values] : collected.values) values.resize(counts.at(commit), worst);
    std::erase_if(collected.values,
                  [](const auto& entry) { return !std::isfinite(*eval::percentile(entry.second, 0.5)); });
    return collected;
  }

  static HistorySeries series_of(const Key& key, const SeriesValues& collected,
                                 const std::map<std::string, std::size_t>& index) {
    HistorySeries series{.subject = key.first,
                         .plans = {collected.plans.begin(), collected.plans.end()},
                         .metric = key.second,
                         .unit = collected.unit,
                         .gated = collected.gated};
    std::vector<std::pair<std::size_t, const std::vector<double>*>> ordered;
    for (const auto& [commit, values] : collected.values) ordered.emplace_back(index.at(commit), &values);
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
  std::map<HistorySubject, std::map<std::string, std::size_t>> succeeded_;  // runs by commit
  std::map<std::string, CommitTime> times_;
};

}  // namespace

CommitHistory commit_history(const Store& store) {
  constexpr std::size_t kChunk = 5000;  // runs whose details are in memory
  std::vector<StoredRun> runs = store.run_headers({.system = kOwnSystem});
  HistoryBuilder builder(plans_by_run(store, runs));
  const std::vector<RunOrigin> origins = run_origins(store, runs);
  for (std::size_t begin = 0; begin < runs.size(); begin += kChunk) {
    const auto first = runs.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = first + static_cast<std::ptrdiff_t>(std::min(kChunk, runs.size() - begin));
    const std::vector<StoredRun> chunk =
        store.with_details({std::make_move_iterator(first), std::make_move_iterator(last)});
    for (std::size_t i = 0; i < chunk.size(); ++i) builder.add(chunk[i], origins[begin + i]);
  }
  return builder.build();
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
