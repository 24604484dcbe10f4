// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/metric_change.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "bench/analysis/missing_results.h"
#include "bench/analysis/unlike_results.h"
#include "core/base/module_timings.h"
#include "eval/metrics/statistics.h"
#include "eval/statistics/change_points.h"

namespace stillpoint::bench {
namespace {

/// Data, seed and config of a run.
using Input = std::pair<std::string, std::string>;

Input input_of(const RunIdentity& identity) {
  return {input_key(identity), std::string(unperturbed_hash(identity.config_hash))};
}

/// Runs of one side, each fingerprint once.
class DistinctRuns {
 public:
  /// @return whether it is new
  bool add(const StoredRun& run) {
    const std::string result = fingerprint(run);
    if (!fingerprints_.insert(result).second && !result.empty()) return false;
    runs_.push_back(&run);
    return true;
  }
  [[nodiscard]] bool contains(const StoredRun& run) const {
    const std::string result = fingerprint(run);
    return !result.empty() && fingerprints_.contains(result);
  }
  /// @param like a metric of equal name, protocol and unit
  [[nodiscard]] std::vector<double> values(const Metric& like) const {
    std::vector<double> values;
    for (const StoredRun* run : runs_) {
      for (const Metric& metric : run->metrics) {
        if (metric.name == like.name && metric.protocol == like.protocol && metric.unit == like.unit &&
            std::isfinite(metric.value))
          values.push_back(metric.value);
      }
    }
    return values;
  }

 private:
  std::set<std::string> fingerprints_;
  std::vector<const StoredRun*> runs_;
};

/// The paired runs of one variant on one sequence.
struct PairedSubject {
  std::vector<RunPair> pairs;  ///< without those that repeat a result of base or of head
  std::vector<RunPair> all;
  std::set<Input> inputs;  ///< of `pairs`
  DistinctRuns base;
  DistinctRuns head;
  bool any_failed = false;

  /// Whether the difference has no noise: enough repetitions of each side, without perturbation, and all runs
  /// of a side have one trajectory to the bit.
  /// @param needed see `exact_repetitions`
  [[nodiscard]] bool is_deterministic(std::size_t needed) const {
    if (pairs.size() != 1 || any_failed) return false;
    const RunPair& first = pairs.front();
    std::size_t repetitions = 0;
    for (const RunPair& pair : all) {
      for (const auto& [run, same] : {std::pair(pair.base, first.base), {pair.head, first.head}}) {
        const auto trajectory = run->blobs.find("trajectory");
        if (trajectory == run->blobs.end() || fingerprint(*run) != fingerprint(*same)) return false;
      }
      const RunIdentity& identity = pair.base->identity;
      const bool repeats = identity.seed == first.base->identity.seed && !is_perturbed(identity.config_hash);
      repetitions += repeats ? 1 : 0;
    }
    return repetitions >= needed;
  }

  /// Runs with equal results are copies, whatever their seeds: a seed that a recorded sequence does not use,
  /// or a repetition of a deterministic program.
  void add(const RunPair& pair) {
    all.push_back(pair);
    if (base.contains(*pair.base) || head.contains(*pair.head)) return;
    base.add(*pair.base);
    head.add(*pair.head);
    inputs.insert(input_of(pair.base->identity));
    pairs.push_back(pair);
  }

  /// The runs of one side, and its perturbed runs without counterpart.
  [[nodiscard]] DistinctRuns side(const StoredRun* RunPair::*member,
                                  const std::vector<const StoredRun*>& others) const {
    DistinctRuns runs;
    for (const RunPair& pair : all) runs.add(*(pair.*member));
    const Input input = input_of((pairs.front().*member)->identity);
    for (const StoredRun* run : others) {
      const RunIdentity& identity = run->identity;
      if (run->outcome == Outcome::kOk && is_perturbed(identity.config_hash) && input_of(identity) == input)
        runs.add(*run);
    }
    return runs;
  }
};

MetricSeries series_of(const Metric& stored, const PairedSubject& runs) {
  const RunIdentity& identity = runs.pairs.front().base->identity;
  MetricSeries series{.metric = stored.name,
                      .subject = subject_label(identity),
                      .variant = variant_label(identity),
                      .unit = stored.unit,
                      .descriptor = gated_metric(stored.name),
                      .inputs = runs.inputs.size(),
                      .is_noisy = !repeats_by_design(identity)};
  for (const RunPair& pair : runs.pairs) {
    if (const std::optional<eval::Pair> values = comparable_values(pair, stored.name))
      series.pairs.push_back(*values);
  }
  return series;
}

/// Whether base has a 0, from which there is no relative change.
bool has_zero_base(const MetricSeries& series) {
  return std::ranges::any_of(series.pairs, [](const eval::Pair& pair) { return pair.base == 0.0; });
}

bool is_gated(const Metric& metric, MetricFamily family) {
  const MetricDescriptor* descriptor = gated_metric(metric.name);
  return descriptor != nullptr && descriptor->gate->family == family;
}

/// Metrics of accuracy that any run of base has, each name once.
std::vector<Metric> accuracy_metrics(const PairedSubject& runs) {
  std::map<std::string, Metric> metrics;
  for (const RunPair& pair : runs.pairs) {
    for (const Metric& metric : pair.base->metrics) {
      if (is_gated(metric, MetricFamily::kAccuracy) && comparable_values(pair, metric.name))
        metrics.emplace(metric.name, metric);
    }
  }
  std::vector<Metric> list;
  list.reserve(metrics.size());
  for (const auto& [name, metric] : metrics) list.push_back(metric);
  return list;
}

/// Series of costs by metric and subject.
class CostTable {
 public:
  /// @param decides whether the cost is measured by these runs, not only reported
  void add(const RunIdentity& identity, const Metric& stored, const eval::Pair& pair, bool decides) {
    const MetricDescriptor* known = gated_metric(stored.name);
    const MetricDescriptor& metric = known != nullptr ? *known : *gated_metric(metric_id::kModuleTime);
    const bool is_exact = metric.gate->repeatable;
    const std::string subject = is_exact ? subject_label(identity) : variant_label(identity);
    const Key key{stored.name, subject, decides || is_exact};
    MetricSeries& series = table_[key];
    series.metric = stored.name;
    series.subject = subject;
    series.variant = variant_label(identity);
    series.unit = stored.unit;
    series.descriptor = &metric;
    series.test = is_exact ? ChangeTest::kExact : ChangeTest::kPairs;
    series.is_noisy = !is_exact;
    series.decides = decides || is_exact;
    if (std::isfinite(pair.base) && std::isfinite(pair.changed)) series.pairs.push_back(pair);
    inputs_[key].insert(input_of(identity));
    series.inputs = inputs_[key].size();
    sequences_[key].insert(identity.sequence);
    series.sequences = sequences_[key].size();
  }

  /// Runs that were not made to measure a cost are left out if others were.
  [[nodiscard]] std::vector<MetricSeries> all() const {
    std::vector<MetricSeries> list;
    for (const auto& [key, series] : table_) {
      const auto& [metric, subject, decides] = key;
      if (decides || !table_.contains({metric, subject, true})) list.push_back(series);
    }
    return list;
  }

 private:
  using Key = std::tuple<std::string, std::string, bool>;
  std::map<Key, MetricSeries> table_;
  std::map<Key, std::set<Input>> inputs_;
  std::map<Key, std::set<std::string>> sequences_;
};

/// Variants whose times were measured on one machine, base and head in turn.
std::set<std::string> variants_with_times(const PairedRuns& runs) {
  std::map<std::string, std::vector<RunPair>> timed;
  for (const RunPair& pair : runs.pairs) {
    if (both_succeeded(pair) && measures_costs(pair.base->identity))
      timed[variant_label(pair.base->identity)].push_back(pair);
  }
  std::set<std::string> variants;
  for (const auto& [variant, pairs] : timed) {
    if (is_interleaved(pairs) && std::ranges::all_of(pairs, on_same_machine)) variants.insert(variant);
  }
  return variants;
}

/// Pairs that the signed-rank test does not omit.
std::size_t different_pairs(const MetricSeries& series) {
  return static_cast<std::size_t>(
      std::count_if(series.pairs.begin(), series.pairs.end(),
                    [](const eval::Pair& pair) { return pair.base != pair.changed; }));
}

std::vector<double> sorted(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values;
}

}  // namespace

std::size_t exact_repetitions(const RunIdentity& run, std::size_t subjects) {
  std::size_t count = 2;
  double by_chance = 2.0 / 16.0 * static_cast<double>(subjects);
  for (; !repeats_by_design(run) && by_chance > kSignificance; by_chance /= 4.0) ++count;
  return count;
}

std::vector<MetricSeries> accuracy_series(const PairedRuns& runs) {
  std::map<std::string, PairedSubject> subjects;
  for (const RunPair& pair : runs.pairs) {
    PairedSubject& subject = subjects[subject_label(pair.base->identity)];
    if (both_succeeded(pair)) {
      subject.add(pair);
    } else {
      subject.any_failed = true;
    }
  }
  std::vector<MetricSeries> list;
  for (const auto& [subject, members] : subjects) {
    for (const Metric& metric : accuracy_metrics(members)) {
      MetricSeries series = series_of(metric, members);
      if (series.pairs.empty()) continue;
      series.repetitions = exact_repetitions(members.pairs.front().base->identity, subjects.size());
      // The rank test of two samples counts ties against a difference: of little power for rates that are
      // mostly 0.
      if (members.is_deterministic(series.repetitions)) {
        series.test = ChangeTest::kExact;
      } else if (series.inputs == 1 && !has_zero_base(series)) {
        series.test = ChangeTest::kReplicates;
        series.base = members.side(&RunPair::base, runs.only_in_base).values(metric);
        series.head = members.side(&RunPair::head, runs.only_in_head).values(metric);
      }
      list.push_back(std::move(series));
    }
  }
  return list;
}

std::vector<MetricSeries> cost_series(const PairedRuns& runs) {
  CostTable table;
  const std::set<std::string> with_times = variants_with_times(runs);
  for (const RunPair& pair : runs.pairs) {
    if (!both_succeeded(pair)) continue;
    const RunIdentity& identity = pair.base->identity;
    const bool decides = measures_costs(identity);
    const bool times_decide = decides && with_times.contains(variant_label(identity));
    for (const Metric& metric : pair.base->metrics) {
      const std::optional<eval::Pair> values = comparable_values(pair, metric.name);
      if (values && is_gated(metric, MetricFamily::kCost))
        table.add(identity, metric, *values, is_time(*gated_metric(metric.name)) ? times_decide : decides);
    }
    for (const ModuleCost& base : pair.base->costs) {
      for (const ModuleCost& head : pair.head->costs) {
        if (base.module == head.module && base.per == head.per)
          table.add(identity, {.name = base.module, .unit = "ms"}, {base.mean_ms, head.mean_ms},
                    times_decide);
      }
    }
  }
  return table.all();
}

MetricSeries pooled(const std::vector<const MetricSeries*>& parts) {
  MetricSeries series = *parts.front();
  const bool is_one_variant =
      std::ranges::all_of(parts, [&](const MetricSeries* part) { return part->variant == series.variant; });
  series.subject = is_one_variant ? series.variant + " on all sequences" : "all variants on all sequences";
  series.test = ChangeTest::kPairs;
  series.decides = true;
  series.inputs = 0;
  series.sequences = 0;
  series.pairs.clear();
  series.base.clear();
  series.head.clear();
  for (const MetricSeries* part : parts) {
    series.inputs += part->inputs;
    series.sequences += part->sequences;
    series.is_noisy = series.is_noisy || part->is_noisy;
    series.pairs.insert(series.pairs.end(), part->pairs.begin(), part->pairs.end());
  }
  return series;
}

bool is_tested(const MetricSeries& series) {
  if (series.test == ChangeTest::kExact) return false;
  if (series.test == ChangeTest::kReplicates) return sorted(series.base) != sorted(series.head);
  return different_pairs(series) > 0;
}

namespace {

std::size_t gated_count(MetricSource source) {
  const std::vector<const MetricDescriptor*> metrics = metrics_of(source);
  return static_cast<std::size_t>(
      std::count_if(metrics.begin(), metrics.end(),
                    [](const MetricDescriptor* metric) { return metric->gate.has_value(); }));
}

using Variant = std::tuple<std::string, std::string, double>;  // with the sweep point
using Inputs = std::set<std::string>;

}  // namespace

TestFamily test_family(std::vector<TestedSeries> tests) {
  const std::size_t with_too_few =
      std::erase_if(tests, [](const TestedSeries& test) { return test.smallest_p > kSignificance; });
  std::ranges::sort(tests, {}, &TestedSeries::p_value);
  TestFamily family{.tests = tests.size(), .with_too_few = with_too_few};
  if (tests.empty()) return family;
  const double first_level = kSignificance / static_cast<double>(tests.size());
  family.level = first_level;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const double level = first_level * static_cast<double>(i + 1);
    if (tests[i].p_value <= level) family.level = level;
  }
  return family;
}

double smallest_rank_sum_p(std::size_t first, std::size_t second) {
  if (first == 0 || second == 0) return 1.0;
  double arrangements = 1.0;  // (m + n)! / (m! n!)
  for (std::size_t i = 1; i <= second; ++i)
    arrangements *= static_cast<double>(first + i) / static_cast<double>(i);
  return std::min(1.0, 2.0 / arrangements);
}

std::size_t replicates_for(double level) {
  std::size_t count = 1;
  while (smallest_rank_sum_p(count, count) > level) ++count;
  return count;
}

std::size_t pairs_for_plan(std::span<const RunIdentity> runs) {
  if (runs.empty() || runs.front().kind == "instructions") return 1;
  std::map<Variant, Inputs> variants;
  std::map<std::pair<Variant, std::string>, Inputs> subjects;
  for (const RunIdentity& run : runs) {
    const Variant variant{run.variant, run.axis, run.axis_value};
    variants[variant].insert(input_key(run));
    subjects[{variant, run.sequence}].insert(input_key(run));
  }
  const std::size_t tests = gated_count(MetricSource::kTrajectory) * subjects.size() +
                            (gated_count(MetricSource::kProcess) + kModuleCount) * variants.size();
  const double level = kSignificance / static_cast<double>(tests);
  std::size_t pairs = 1;
  const auto needs_pairs = [&](std::size_t inputs) {
    pairs = std::max(pairs, (eval::smallest_count(level) + inputs - 1) / inputs);
  };
  for (const auto& [variant, inputs] : variants) needs_pairs(inputs.size());
  for (const auto& [subject, inputs] : subjects) {
    if (inputs.size() > 1) {
      needs_pairs(inputs.size());
    } else {
      pairs = std::max(pairs, replicates_for(level));
    }
  }
  return pairs;
}

double smallest_p_of(const MetricSeries& series) {
  return series.test == ChangeTest::kReplicates ? smallest_rank_sum_p(series.base.size(), series.head.size())
                                                : eval::smallest_p(different_pairs(series));
}

std::size_t pairs_for(const MetricSeries& series, double level) {
  if (series.test == ChangeTest::kReplicates) return replicates_for(level);
  return (eval::smallest_count(level) + series.inputs - 1) / series.inputs;
}

std::size_t seeds_for(const MetricSeries& series, double level) {
  return (eval::smallest_count(level) + series.sequences - 1) / series.sequences;
}

namespace {

std::optional<eval::RelativeChange> tested_shift(const MetricSeries& series, double confidence) {
  const std::optional<eval::PairedDifference> test = eval::paired_difference(series.pairs, confidence);
  if (!test) return std::nullopt;
  return eval::RelativeChange{
      .count = test->count, .median = test->median, .p_value = test->p_value, .interval = test->interval};
}

/// Means of base and head.
std::pair<double, double> means_of(const MetricSeries& series) {
  std::pair<double, double> means;
  for (const eval::Pair& pair : series.pairs) {
    means.first += pair.base / static_cast<double>(series.pairs.size());
    means.second += pair.changed / static_cast<double>(series.pairs.size());
  }
  return means;
}

/// The difference in the unit of the metric. If most runs have the same value, e.g. 0, the
/// shift is 0, and the difference is that of the means, without an interval.
std::optional<eval::RelativeChange> tested_difference(const MetricSeries& series, double confidence) {
  std::optional<eval::RelativeChange> change = tested_shift(series, confidence);
  if (!change || change->median != 0.0) return change;
  const auto [base, head] = means_of(series);
  if (base == head) return change;
  change->median = head - base;
  change->interval.reset();
  return change;
}

std::optional<eval::RelativeChange> tested_change(const MetricSeries& series, double confidence) {
  std::optional<eval::RelativeChange> change;
  if (has_zero_base(series)) {
    change = tested_difference(series, confidence);
  } else if (series.test == ChangeTest::kReplicates) {
    change = eval::level_change(series.base, series.head, confidence);
  } else {
    change = eval::relative_change(series.pairs, confidence);
  }
  if (change && series.test == ChangeTest::kExact) change->interval.reset();
  return change;
}

/// head - base in the unit of the metric.
struct Difference {
  double estimate = 0.0;
  std::optional<eval::Interval> interval;
};

/// Of the same pairs or replicates as the test: the medians of all values say nothing about them if the
/// sequences have different levels.
Difference difference_of(const MetricSeries& series, const MetricChange& change) {
  if (change.is_absolute) return {change.change.median, change.change.interval};
  if (series.test == ChangeTest::kReplicates) {
    const std::optional<eval::RankSum> shift = eval::rank_sum(series.base, series.head, 1.0 - kSignificance);
    return shift ? Difference{shift->shift, shift->interval} : Difference{};
  }
  const std::optional<eval::PairedDifference> paired =
      eval::paired_difference(series.pairs, 1.0 - kSignificance);
  return paired ? Difference{paired->median, paired->interval} : Difference{};
}

/// The largest change of a pair whose difference is at least the floor.
double largest_change(const std::vector<eval::Pair>& pairs, bool is_absolute, double floor) {
  double largest = 0.0;
  for (const eval::Pair& pair : pairs) {
    const double difference = std::abs(pair.changed - pair.base);
    if (difference < floor) continue;
    largest = std::max(largest, is_absolute ? difference : difference / std::abs(pair.base));
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

/// The margin in the unit of `change`.
double margin_of(const MetricChange& change, const MetricGate& gate) {
  return change.is_absolute ? std::max(gate.floor, gate.margin * std::abs(change.base_median)) : gate.margin;
}

bool is_relevant(const MetricChange& change, const MetricGate& gate) {
  return std::abs(change.difference) >= gate.floor && change.change.median != 0.0 &&
         std::abs(change.change.median) >= margin_of(change, gate);
}

bool is_within(const std::optional<eval::Interval>& interval, double limit) {
  return interval && interval->low >= -limit && interval->high <= limit;
}

}  // namespace

double p_value_of(const MetricSeries& series) {
  const std::optional<eval::RelativeChange> change = tested_change(series, 1.0 - kSignificance);
  return change ? change->p_value : 1.0;
}

namespace {

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
                      .is_absolute = has_zero_base(series),
                      .test = series.test,
                      .is_noisy = series.is_noisy,
                      .level = series.decides ? family.level : 0.0};
  if (series.decides) change.adjusted_interval = tested_change(series, 1.0 - family.level)->interval;
  const MetricGate& gate = *series.descriptor->gate;
  const Difference difference = difference_of(series, change);
  change.difference = difference.estimate;
  change.difference_interval = difference.interval;
  change.largest = largest_change(series.pairs, change.is_absolute, gate.floor);
  change.changed = is_relevant(change, gate);
  change.decides = series.decides;
  if (is_tested(series)) {
    change.smallest_p = smallest_p_of(series);
    // More runs also make tests of those that are left out.
    const std::size_t tests = family.tests + family.with_too_few;
    const double level = kSignificance / static_cast<double>(std::max<std::size_t>(1, tests));
    const std::size_t needed = pairs_for(series, level);
    if (change.smallest_p > change.level && needed * series.inputs > tested->count) {
      change.needed = needed;
      change.needed_seeds = seeds_for(series, level);
      change.repetitions = series.repetitions;
    }
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
    case ChangeClass::kMissing:
      return "missing in HEAD";
    case ChangeClass::kWorse:
      return "worse";
    case ChangeClass::kError:
      return "error";
  }
  return "";
}

std::string amount_text(const MetricChange& change, double amount) {
  if (!change.is_absolute) return fmt::format("{:+.1f} %", 100.0 * amount);
  return fmt::format("{:+.4g}{}{}", amount, change.unit.empty() ? "" : " ", change.unit);
}

ChangeClass classify(const MetricChange& change, const MetricDescriptor& metric) {
  const MetricGate& gate = *metric.gate;
  const double sign =
      metric.direction == MetricDirection::kLargerIsBetter ? -1.0 : 1.0;  // so that positive is worse
  const double margin = margin_of(change, gate);
  const bool relevant = is_relevant(change, gate);
  const ChangeClass direction =
      sign * change.change.median > 0.0 ? ChangeClass::kWorse : ChangeClass::kBetter;
  if (change.test == ChangeTest::kExact) return relevant ? direction : ChangeClass::kSame;
  if (relevant && change.change.p_value <= change.level) return direction;
  const double limit = change.is_noisy ? 0.0 : margin;
  const bool is_same = change.change.interval ? is_within(change.change.interval, margin) ||
                                                    is_within(change.difference_interval, gate.floor)
                                              : change.largest <= limit;
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
