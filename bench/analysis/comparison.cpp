// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

constexpr std::size_t kMinPairs = 5;

struct RunPair {
  const StoredRun* base;
  const StoredRun* head;
};

/// Key that is equal for paired runs: everything but the build.
std::string pair_key(const RunIdentity& identity) {
  RunIdentity any_build = identity;
  any_build.build.clear();
  any_build.config_hash.clear();  // defaults may change with the build
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

/// Paired values of one metric on one subject.
struct Series {
  const MetricDescriptor* metric = nullptr;  ///< with a gate
  std::string unit;
  bool repeatable = true;
  std::vector<eval::Pair> pairs;
};

/// By (metric, subject).
using SeriesTable = std::map<std::pair<std::string, std::string>, Series>;

/// Repeatable metrics are tested per sequence; the others need all runs of a variant.
std::string subject_of(const RunIdentity& identity, const MetricGate& gate) {
  std::string subject = identity.variant;
  if (!identity.axis.empty()) subject += fmt::format(" {} = {}", identity.axis, identity.axis_value);
  return gate.repeatable ? subject + " on " + identity.sequence : subject;
}

SeriesTable metric_series(const std::vector<RunPair>& pairs, MetricFamily family) {
  SeriesTable table;
  for (const RunPair& pair : pairs) {
    const RunIdentity& identity = pair.base->identity;
    for (const Metric& stored : pair.base->metrics) {
      const MetricDescriptor* metric = gated_metric(stored.name);
      const std::optional<double> head = metric_value(*pair.head, stored.name);
      if (metric == nullptr || metric->gate->family != family || !head) continue;
      Series& series = table[{stored.name, subject_of(identity, *metric->gate)}];
      series.metric = metric;
      series.unit = stored.unit;
      series.repeatable = metric->gate->repeatable && identity.mode != "realtime";
      series.pairs.push_back({stored.value, *head});
    }
  }
  return table;
}

SeriesTable module_series(const std::vector<RunPair>& pairs) {
  const MetricDescriptor* metric = gated_metric(metric_id::kModuleTime);
  SeriesTable table;
  for (const RunPair& pair : pairs) {
    for (const ModuleCost& cost : pair.base->costs) {
      for (const ModuleCost& other : pair.head->costs) {
        if (cost.module != other.module) continue;
        Series& series = table[{cost.module, subject_of(pair.base->identity, *metric->gate)}];
        series.metric = metric;
        series.unit = std::string(metric->unit);
        series.repeatable = metric->gate->repeatable;
        series.pairs.push_back({cost.mean_ms, other.mean_ms});
      }
    }
  }
  return table;
}

std::optional<MetricChange> change_of(const std::pair<std::string, std::string>& name, const Series& series,
                                      std::size_t family_size) {
  const std::optional<eval::RelativeChange> change = eval::relative_change(series.pairs);
  if (!change) return std::nullopt;
  const double confidence =
      1.0 - (1.0 - eval::BootstrapOptions{}.confidence) / static_cast<double>(family_size);
  std::vector<double> base;
  std::vector<double> head;
  for (const eval::Pair& pair : series.pairs) {
    base.push_back(pair.base);
    head.push_back(pair.changed);
  }
  MetricChange metric_change{
      .metric = name.first,
      .subject = name.second,
      .unit = series.unit,
      .base_median = *eval::percentile(base, 0.5),
      .head_median = *eval::percentile(head, 0.5),
      .change = *change,
      .adjusted_interval = eval::relative_change(series.pairs, {.confidence = confidence})->interval};
  metric_change.result = classify(metric_change, *series.metric, series.repeatable);
  return metric_change;
}

/// The interval multiplied by `sign`, 1 or -1.
eval::Interval oriented(const eval::Interval& interval, double sign) {
  return sign > 0.0 ? interval : eval::Interval{.low = -interval.high, .high = -interval.low};
}

std::vector<MetricChange> changes_of(const SeriesTable& table) {
  std::vector<MetricChange> changes;
  for (const auto& [name, series] : table) {
    if (const std::optional<MetricChange> change = change_of(name, series, table.size()))
      changes.push_back(*change);
  }
  return changes;
}

bool is_busy(const StoredRun& run) { return metric_value(run, metric_id::kQuiet) == 0.0; }

/// A comparison with the counts of outcomes, without changes.
Comparison counted_outcomes(const std::vector<RunPair>& pairs) {
  Comparison comparison{.pairs = pairs.size()};
  std::size_t busy = 0;
  for (const RunPair& pair : pairs) {
    const bool base_ok = pair.base->outcome == Outcome::kOk;
    const bool head_ok = pair.head->outcome == Outcome::kOk;
    comparison.newly_failed += base_ok && !head_ok ? 1 : 0;
    comparison.newly_succeeded += !base_ok && head_ok ? 1 : 0;
    comparison.bit_equal += both_ok(pair) && is_bit_equal(pair) ? 1 : 0;
    busy += is_busy(*pair.base) || is_busy(*pair.head) ? 1 : 0;
  }
  if (busy > 0) {
    comparison.notes.push_back(fmt::format("the machine was busy during {} of {} pairs", busy, pairs.size()));
  }
  return comparison;
}

}  // namespace

std::string change_class_name(ChangeClass change_class) {
  switch (change_class) {
    case ChangeClass::kSame:
      return "same";
    case ChangeClass::kBetter:
      return "better";
    case ChangeClass::kInconclusive:
      return "inconclusive";
    case ChangeClass::kWorse:
      return "worse";
  }
  return "";
}

ChangeClass classify(const MetricChange& change, const MetricDescriptor& metric, bool repeatable) {
  const MetricGate& gate = *metric.gate;
  if (std::abs(change.head_median - change.base_median) < gate.floor) return ChangeClass::kSame;
  const double sign =
      metric.direction == MetricDirection::kLargerIsBetter ? -1.0 : 1.0;  // so that positive is worse
  const double median = sign * change.change.median;
  const eval::Interval interval = oriented(change.change.interval, sign);
  const eval::Interval adjusted_interval = oriented(change.adjusted_interval, sign);
  const bool is_equal = interval.low == 0.0 && interval.high == 0.0;
  if (!repeatable && change.change.count < kMinPairs && !is_equal) return ChangeClass::kInconclusive;
  if (adjusted_interval.low > 0.0 && median >= gate.margin) return ChangeClass::kWorse;
  if (adjusted_interval.high < 0.0 && median <= -gate.margin) return ChangeClass::kBetter;
  const bool is_same = interval.low >= -gate.margin && interval.high <= gate.margin;
  return is_same ? ChangeClass::kSame : ChangeClass::kInconclusive;
}

ChangeClass Comparison::result() const {
  if (pairs == 0) return ChangeClass::kInconclusive;
  if (newly_failed > 0) return ChangeClass::kWorse;
  ChangeClass worst = newly_succeeded > 0 ? ChangeClass::kBetter : ChangeClass::kSame;
  for (const MetricChange& change : changes) worst = std::max(worst, change.result);
  return worst;
}

Comparison compare_runs(std::span<const StoredRun> base, std::span<const StoredRun> head) {
  std::vector<RunPair> pairs = pairs_of(base, head);
  Comparison comparison = counted_outcomes(pairs);
  std::erase_if(pairs, [](const RunPair& pair) { return !both_ok(pair); });
  const bool accuracy_is_equal = !pairs.empty() && comparison.bit_equal == pairs.size();
  if (!accuracy_is_equal) comparison.changes = changes_of(metric_series(pairs, MetricFamily::kAccuracy));
  SeriesTable costs = metric_series(pairs, MetricFamily::kCost);
  costs.merge(module_series(pairs));
  const std::vector<MetricChange> cost_changes = changes_of(costs);
  comparison.changes.insert(comparison.changes.end(), cost_changes.begin(), cost_changes.end());
  if (accuracy_is_equal)
    comparison.notes.emplace_back("all trajectories are bit-equal: accuracy was not tested");
  return comparison;
}

Comparison with_control(Comparison comparison, const Comparison& control) {
  comparison.control = control.changes;
  for (MetricChange& change : comparison.changes) {
    for (const MetricChange& control_change : control.changes) {
      const bool is_significant =
          control_change.result == ChangeClass::kWorse || control_change.result == ChangeClass::kBetter;
      if (control_change.metric != change.metric || control_change.subject != change.subject ||
          !is_significant)
        continue;
      change.result = ChangeClass::kInconclusive;
      comparison.notes.push_back(fmt::format("{} of {} changed by {:+.1f} % between runs of base alone",
                                             change.metric, change.subject,
                                             100.0 * control_change.change.median));
    }
  }
  return comparison;
}

}  // namespace stillpoint::bench
