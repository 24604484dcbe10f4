// SPDX-License-Identifier: BSD-3-Clause
#include "bench/compare/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "eval/metrics/statistics.h"

namespace stillpoint {
namespace {

constexpr std::size_t kFewestPairs = 5;

struct RunPair {
  const StoredRun* base;
  const StoredRun* head;
};

/// What must agree for two runs to be a pair: everything but the build.
std::string pair_key(const RunIdentity& identity) {
  RunIdentity any_build = identity;
  any_build.build.clear();
  any_build.config_hash.clear();  // defaults may change with the build; that is part of the change
  return run_key(any_build);
}

std::vector<RunPair> pairs_of(std::span<const StoredRun> base, std::span<const StoredRun> head) {
  std::map<std::string, const StoredRun*> by_key;
  for (const StoredRun& run : head) by_key[pair_key(run.identity)] = &run;
  std::vector<RunPair> pairs;
  for (const StoredRun& run : base) {
    const auto found = by_key.find(pair_key(run.identity));
    if (found != by_key.end()) pairs.push_back({&run, found->second});
  }
  return pairs;
}

bool both_ok(const RunPair& pair) {
  return pair.base->outcome == Outcome::kOk && pair.head->outcome == Outcome::kOk;
}

bool is_bit_equal(const RunPair& pair) {
  const auto base = pair.base->blobs.find("trajectory");
  const auto head = pair.head->blobs.find("trajectory");
  return base != pair.base->blobs.end() && head != pair.head->blobs.end() && base->second == head->second;
}

/// The pairs of values of one metric on one subject.
struct Series {
  MetricRule rule;
  std::string unit;
  bool repeatable = true;
  std::vector<Pair> pairs;
};

/// Series by metric and subject, in this order.
using SeriesTable = std::map<std::pair<std::string, std::string>, Series>;

/// What repeats is judged sequence by sequence; what varies needs all the runs of a variant together.
std::string subject_of(const RunIdentity& identity, const MetricRule& rule) {
  std::string subject = identity.variant;
  if (!identity.axis.empty()) subject += fmt::format(" {} = {}", identity.axis, identity.axis_value);
  return rule.repeatable ? subject + " on " + identity.sequence : subject;
}

void add_metrics(SeriesTable& table, const RunPair& pair, MetricFamily family) {
  const RunIdentity& identity = pair.base->identity;
  for (const Metric& metric : pair.base->metrics) {
    const std::optional<MetricRule> rule = metric_rule(metric.name);
    const std::optional<double> head = metric_value(*pair.head, metric.name);
    if (!rule || rule->family != family || !head) continue;
    Series& series = table[{metric.name, subject_of(identity, *rule)}];
    series.rule = *rule;
    series.unit = metric.unit;
    series.repeatable = rule->repeatable && identity.mode != "realtime";
    series.pairs.push_back({metric.value, *head});
  }
}

void add_costs(SeriesTable& table, const RunPair& pair) {
  for (const ModuleCost& cost : pair.base->costs) {
    for (const ModuleCost& other : pair.head->costs) {
      if (cost.module != other.module) continue;
      const MetricRule rule = *metric_rule("ms");
      Series& series = table[{cost.module, subject_of(pair.base->identity, rule)}];
      series.rule = rule;
      series.unit = "ms";
      series.repeatable = false;
      series.pairs.push_back({cost.mean_ms, other.mean_ms});
    }
  }
}

std::optional<MetricChange> change_of(const std::pair<std::string, std::string>& name, const Series& series,
                                      std::size_t family_size) {
  const std::optional<RelativeChange> change = relative_change(series.pairs);
  if (!change) return std::nullopt;
  const double shared = 1.0 - (1.0 - BootstrapOptions{}.confidence) / static_cast<double>(family_size);
  std::vector<double> base;
  std::vector<double> head;
  for (const Pair& pair : series.pairs) {
    base.push_back(pair.base);
    head.push_back(pair.changed);
  }
  MetricChange result{.metric = name.first,
                      .subject = name.second,
                      .unit = series.unit,
                      .base_median = *percentile(base, 0.5),
                      .head_median = *percentile(head, 0.5),
                      .change = *change,
                      .guarded = relative_change(series.pairs, {.confidence = shared})->interval};
  result.verdict = judge(result, series.rule, series.repeatable);
  return result;
}

/// The interval of the values times `sign`, 1 or -1.
Interval turned(const Interval& interval, double sign) {
  return sign > 0.0 ? interval : Interval{.low = -interval.high, .high = -interval.low};
}

std::vector<MetricChange> changes_of(const SeriesTable& table) {
  std::vector<MetricChange> changes;
  for (const auto& [name, series] : table) {
    if (const std::optional<MetricChange> change = change_of(name, series, table.size()))
      changes.push_back(*change);
  }
  return changes;
}

void count_outcomes(Comparison& comparison, const std::vector<RunPair>& pairs) {
  std::size_t noisy = 0;
  for (const RunPair& pair : pairs) {
    const bool base_ok = pair.base->outcome == Outcome::kOk;
    const bool head_ok = pair.head->outcome == Outcome::kOk;
    comparison.newly_lost += base_ok && !head_ok ? 1 : 0;
    comparison.newly_won += !base_ok && head_ok ? 1 : 0;
    comparison.bit_equal += both_ok(pair) && is_bit_equal(pair) ? 1 : 0;
    noisy += metric_value(*pair.head, "quiet") == 0.0 || metric_value(*pair.base, "quiet") == 0.0 ? 1 : 0;
  }
  if (noisy > 0) {
    comparison.notes.push_back(
        fmt::format("others used the machine during {} of {} pairs", noisy, pairs.size()));
  }
}

}  // namespace

std::string verdict_name(ChangeVerdict verdict) {
  switch (verdict) {
    case ChangeVerdict::kSame:
      return "same";
    case ChangeVerdict::kBetter:
      return "better";
    case ChangeVerdict::kInconclusive:
      return "inconclusive";
    case ChangeVerdict::kWorse:
      return "worse";
  }
  return "";
}

ChangeVerdict judge(const MetricChange& change, const MetricRule& rule, bool repeatable) {
  if (std::abs(change.head_median - change.base_median) < rule.floor) return ChangeVerdict::kSame;
  const double sign = rule.larger_is_better ? -1.0 : 1.0;  // of what is bad
  const double median = sign * change.change.median;
  const Interval interval = turned(change.change.interval, sign);
  const Interval guarded = turned(change.guarded, sign);
  const bool is_equal = interval.low == 0.0 && interval.high == 0.0;
  if (!repeatable && change.change.count < kFewestPairs && !is_equal) return ChangeVerdict::kInconclusive;
  if (guarded.low > 0.0 && median >= rule.margin) return ChangeVerdict::kWorse;
  if (guarded.high < 0.0 && median <= -rule.margin) return ChangeVerdict::kBetter;
  const bool is_same = interval.low >= -rule.margin && interval.high <= rule.margin;
  return is_same ? ChangeVerdict::kSame : ChangeVerdict::kInconclusive;
}

ChangeVerdict Comparison::verdict() const {
  if (pairs == 0) return ChangeVerdict::kInconclusive;
  if (newly_lost > 0) return ChangeVerdict::kWorse;
  ChangeVerdict worst = newly_won > 0 ? ChangeVerdict::kBetter : ChangeVerdict::kSame;
  for (const MetricChange& change : changes) worst = std::max(worst, change.verdict);
  return worst;
}

Comparison compare_runs(std::span<const StoredRun> base, std::span<const StoredRun> head) {
  const std::vector<RunPair> pairs = pairs_of(base, head);
  Comparison comparison;
  comparison.pairs = pairs.size();
  count_outcomes(comparison, pairs);
  const auto good = static_cast<std::size_t>(std::count_if(pairs.begin(), pairs.end(), both_ok));
  const bool accuracy_is_equal = good > 0 && comparison.bit_equal == good;
  SeriesTable accuracy;
  SeriesTable costs;
  for (const RunPair& pair : pairs) {
    if (!both_ok(pair)) continue;
    if (!accuracy_is_equal) add_metrics(accuracy, pair, MetricFamily::kAccuracy);
    add_metrics(costs, pair, MetricFamily::kCost);
    add_costs(costs, pair);
  }
  comparison.changes = changes_of(accuracy);
  const std::vector<MetricChange> cost_changes = changes_of(costs);
  comparison.changes.insert(comparison.changes.end(), cost_changes.begin(), cost_changes.end());
  if (accuracy_is_equal)
    comparison.notes.emplace_back("every trajectory is bit-equal, so accuracy is the same");
  return comparison;
}

Comparison with_control(Comparison comparison, const Comparison& control) {
  comparison.control = control.changes;
  for (MetricChange& change : comparison.changes) {
    for (const MetricChange& itself : control.changes) {
      const bool moved = itself.verdict == ChangeVerdict::kWorse || itself.verdict == ChangeVerdict::kBetter;
      if (itself.metric != change.metric || itself.subject != change.subject || !moved) continue;
      change.verdict = ChangeVerdict::kInconclusive;
      comparison.notes.push_back(fmt::format("{} of {} changed by {:+.1f} % between runs of base alone",
                                             change.metric, change.subject, 100.0 * itself.change.median));
    }
  }
  return comparison;
}

}  // namespace stillpoint
