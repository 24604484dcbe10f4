// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/metric_change.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "eval/metrics/statistics.h"
#include "eval/statistics/level.h"

namespace stillpoint::bench {
namespace {

std::optional<eval::RelativeChange> tested_change(const MetricSeries& series, double confidence) {
  if (series.test == ChangeTest::kReplicates) return eval::level_change(series.base, series.head, confidence);
  std::optional<eval::RelativeChange> change = eval::relative_change(series.pairs, confidence);
  if (change && series.test == ChangeTest::kExact) change->interval.reset();
  return change;
}

double largest_change(const std::vector<eval::Pair>& pairs) {
  double largest = 0.0;
  for (const eval::Pair& pair : pairs) {
    if (pair.base != 0.0) largest = std::max(largest, std::abs(pair.changed / pair.base - 1.0));
  }
  return largest;
}

std::pair<double, double> medians_of(const MetricSeries& series) {
  if (series.test == ChangeTest::kReplicates)
    return {*eval::percentile(series.base, 0.5), *eval::percentile(series.head, 0.5)};
  std::vector<double> base;
  std::vector<double> head;
  for (const eval::Pair& pair : series.pairs) {
    base.push_back(pair.base);
    head.push_back(pair.changed);
  }
  return {*eval::percentile(base, 0.5), *eval::percentile(head, 0.5)};
}

bool is_relevant(const MetricChange& change, const MetricGate& gate) {
  return std::abs(change.head_median - change.base_median) >= gate.floor &&
         std::abs(change.change.median) >= gate.margin;
}

std::optional<MetricChange> change_of(const MetricSeries& series, const TestFamily& family) {
  const std::optional<eval::RelativeChange> tested = tested_change(series, 1.0 - kSignificance);
  if (!tested) return std::nullopt;
  const auto [base, head] = medians_of(series);
  MetricChange change{.metric = series.metric,
                      .subject = series.subject,
                      .unit = series.unit,
                      .base_median = base,
                      .head_median = head,
                      .change = *tested,
                      .test = series.test,
                      .level = series.decides ? family.level : 0.0};
  if (series.decides) change.adjusted_interval = tested_change(series, 1.0 - family.level)->interval;
  change.largest = largest_change(series.pairs);
  change.changed = is_relevant(change, *series.descriptor->gate);
  change.decides = series.decides;
  if (is_tested(series)) {
    change.smallest_p = smallest_p_of(series);
    if (change.smallest_p > change.level)
      change.needed = pairs_for(series, kSignificance / static_cast<double>(family.tests));
  }
  change.result = classify(change, *series.descriptor);
  return change;
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
    case ChangeClass::kError:
      return "error";
  }
  return "";
}

ChangeClass classify(const MetricChange& change, const MetricDescriptor& metric) {
  const MetricGate& gate = *metric.gate;
  if (std::abs(change.head_median - change.base_median) < gate.floor) return ChangeClass::kSame;
  const double sign =
      metric.direction == MetricDirection::kLargerIsBetter ? -1.0 : 1.0;  // so that positive is worse
  const bool relevant = std::abs(change.change.median) >= gate.margin && change.change.median != 0.0;
  const ChangeClass direction =
      sign * change.change.median > 0.0 ? ChangeClass::kWorse : ChangeClass::kBetter;
  if (change.test == ChangeTest::kExact) return relevant ? direction : ChangeClass::kSame;
  if (relevant && change.change.p_value <= change.level) return direction;
  const double limit = gate.family == MetricFamily::kAccuracy ? gate.margin : 0.0;
  const std::optional<eval::Interval>& interval = change.change.interval;
  const bool is_same =
      interval ? interval->low >= -gate.margin && interval->high <= gate.margin : change.largest <= limit;
  return is_same ? ChangeClass::kSame : ChangeClass::kInconclusive;
}

std::vector<MetricChange> changes_of(const std::vector<MetricSeries>& list, const TestFamily& family) {
  std::vector<MetricChange> changes;
  for (const MetricSeries& series : list) {
    if (const std::optional<MetricChange> change = change_of(series, family)) changes.push_back(*change);
  }
  std::stable_sort(changes.begin(), changes.end(), [](const MetricChange& a, const MetricChange& b) {
    return std::tie(a.metric, a.subject) < std::tie(b.metric, b.subject);
  });
  return changes;
}

}  // namespace stillpoint::bench
