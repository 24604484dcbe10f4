// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/comparison.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "bench/model/stored_run.h"
#include "core/base/counted.h"

namespace stillpoint::bench {
namespace {

bool is_busy(const StoredRun& run) { return metric_value(run, metric_id::kQuiet) == 0.0; }

/// Whether a pair has the same values of all compared metrics of accuracy; true also if a run failed.
bool has_equal_accuracy(const RunPair& pair) {
  if (!both_succeeded(pair)) return true;
  return std::ranges::all_of(pair.base->metrics, [&](const Metric& metric) {
    const MetricDescriptor* gated = gated_metric(metric.name);
    const bool is_accuracy = gated != nullptr && gated->gate->family == MetricFamily::kAccuracy;
    const std::optional<double> head = metric_value(*pair.head, metric.name);
    return !is_accuracy || !head || *head == metric.value;
  });
}

std::string failure_text(const StoredRun& run, const char* side) {
  std::string text = fmt::format("{} on {}, {}: {}", run.identity.variant, run.identity.sequence, side,
                                 outcome_name(run.outcome));
  return run.detail.empty() ? text : text + ", " + run.detail;
}

/// A comparison with the counts of outcomes, without changes.
Comparison counted_outcomes(const PairedRuns& runs) {
  Comparison comparison{.pairs = runs.pairs.size()};
  comparison.only_in_base = runs.only_in_base.size();
  comparison.only_in_head = runs.only_in_head.size();
  std::size_t busy = 0;
  for (const RunPair& pair : runs.pairs) {
    const bool base_ok = pair.base->outcome == Outcome::kOk;
    const bool head_ok = pair.head->outcome == Outcome::kOk;
    comparison.compared += base_ok && head_ok ? 1 : 0;
    comparison.base_failed += base_ok ? 0 : 1;
    comparison.head_failed += head_ok ? 0 : 1;
    comparison.newly_failed += base_ok && !head_ok ? 1 : 0;
    comparison.newly_succeeded += !base_ok && head_ok ? 1 : 0;
    comparison.bit_equal += base_ok && head_ok && is_bit_equal(pair) ? 1 : 0;
    busy += is_busy(*pair.base) || is_busy(*pair.head) ? 1 : 0;
    if (!comparison.first_failure.empty()) continue;
    if (!head_ok) comparison.first_failure = failure_text(*pair.head, "head");
    if (!base_ok) comparison.first_failure = failure_text(*pair.base, "base");
  }
  if (busy > 0)
    comparison.notes.push_back(
        fmt::format("the machine was busy during {} of {} pairs", busy, comparison.pairs));
  return comparison;
}

TestFamily family_of(const std::vector<MetricSeries>& list) {
  std::vector<TestedSeries> tests;
  for (const MetricSeries& series : list) {
    if (series.decides && is_tested(series)) tests.push_back({p_value_of(series), smallest_p_of(series)});
  }
  return test_family(std::move(tests));
}

/// Adds a pooled series for each metric and group of which a member has too few pairs to be significant on
/// its own; members that never can are reported only.
/// @param group of a series, e.g. its variant
std::vector<MetricSeries> with_pooled(std::vector<MetricSeries> list,
                                      std::string (*group)(const MetricSeries&)) {
  const std::size_t tests = family_of(list).tests;
  const double first_level = kSignificance / static_cast<double>(std::max<std::size_t>(tests, 1));
  std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].decides) groups[{list[i].metric, group(list[i])}].push_back(i);
  }
  for (const auto& [name, members] : groups) {
    if (members.size() < 2) continue;
    std::vector<const MetricSeries*> parts;
    bool too_few = false;
    for (const std::size_t i : members) {
      parts.push_back(&list[i]);
      too_few = too_few || (is_tested(list[i]) && smallest_p_of(list[i]) > first_level);
    }
    if (!too_few) continue;
    MetricSeries pool = pooled(parts);
    for (const std::size_t i : members)
      list[i].decides = !is_tested(list[i]) || smallest_p_of(list[i]) <= kSignificance;
    list.push_back(std::move(pool));
  }
  return list;
}

/// Pooled over the sequences of each variant; if the pairs are still too few, over the variants instead.
std::vector<MetricSeries> with_all_pools(const std::vector<MetricSeries>& accuracy) {
  std::vector<MetricSeries> of_variants =
      with_pooled(accuracy, [](const MetricSeries& series) { return series.variant; });
  const bool can_reject = std::ranges::any_of(of_variants, [](const MetricSeries& series) {
    return series.decides && is_tested(series) && smallest_p_of(series) <= kSignificance;
  });
  if (can_reject) return of_variants;
  return with_pooled(accuracy, [](const MetricSeries&) { return std::string(); });
}

/// Whether a cost changed that the runs were not made to measure.
bool is_reported_cost(const MetricChange& change) {
  const MetricDescriptor* gated = gated_metric(change.metric);  // null: a module
  const bool is_cost = gated == nullptr || gated->gate->family == MetricFamily::kCost;
  return is_cost && change.changed && !change.decides;
}

/// One sentence if runs with different seeds or repetitions are copies of each other.
std::vector<std::string> notes_on_copies(const PairedRuns& runs) {
  std::map<std::string, std::set<std::string>> results;
  std::size_t count = 0;
  std::size_t copies = 0;
  for (const RunPair& pair : runs.pairs) {
    if (!both_succeeded(pair)) continue;
    ++count;
    const std::string result = fingerprint(*pair.head);
    const bool is_new = results[subject_label(pair.head->identity)].insert(result).second;
    copies += is_new || result.empty() ? 0 : 1;
  }
  if (copies == 0) return {};
  return {
      fmt::format("{} of {} runs of head have the result of another seed or repetition to the bit: copies, "
                  "which count once; "
                  "vary {} to obtain replicates of a deterministic run",
                  copies, count, kPerturbationKey)};
}

/// What to do about too few runs: perturbations of one input are replicates, seeds are pairs.
std::string advice_of(const MetricChange& change, CompareSource source) {
  if (source == CompareSource::kPrograms)
    return fmt::format("run with --pairs {}", std::max(change.needed, change.repetitions));
  const std::string perturbations =
      change.test == ChangeTest::kReplicates ? fmt::format("{} perturbations or ", change.needed) : "";
  const std::string repetitions =
      change.repetitions > 0
          ? fmt::format(", or execute each run {} times: bit-equal repetitions make a change exact",
                        change.repetitions)
          : "";
  return fmt::format("store {}{} seeds of each sequence{}", perturbations, change.needed_seeds, repetitions);
}

/// One sentence for each number of pairs that is too small for the inconclusive changes.
std::vector<std::string> notes_on_pairs(const Comparison& comparison, CompareSource source) {
  std::map<std::tuple<ChangeTest, std::size_t, double, std::string>, std::size_t> counts;
  for (const MetricChange& change : comparison.changes) {
    if (change.needed > 0 && change.result == ChangeClass::kInconclusive)
      ++counts[{change.test, change.change.count, change.smallest_p, advice_of(change, source)}];
  }
  const TestFamily& family = comparison.family;
  const std::string tests = family.tests > 1 ? fmt::format("{} tests at once require", family.tests)
                                             : "a significant change requires";
  std::vector<std::string> notes;
  for (const auto& [too_few, metrics] : counts) {
    const auto& [test, count, smallest_p, advice] = too_few;
    const char* noun = test == ChangeTest::kReplicates ? "replicate" : "pair";
    notes.push_back(
        fmt::format("{} {}{} cannot go below p = {:.2g}, but {} p <= {:.2g}: {} change{} remain{} "
                    "inconclusive; {}",
                    count, noun, count == 1 ? "" : "s", smallest_p, tests, family.level, metrics,
                    metrics == 1 ? "" : "s", metrics == 1 ? "s" : "", advice));
  }
  return notes;
}

/// Runs whose repetition is odd or even, numbered such that repetitions 2k - 1 and 2k are paired.
std::vector<StoredRun> half_of(std::span<const StoredRun> runs, std::int64_t parity) {
  std::vector<StoredRun> half;
  for (const StoredRun& run : runs) {
    if (run.identity.repetition % 2 != parity) continue;
    half.push_back(run);
    RunIdentity& identity = half.back().identity;
    identity.repetition = (identity.repetition + 1) / 2;
    identity.config_hash = unperturbed_hash(identity.config_hash);
  }
  return half;
}

bool is_significant(const MetricChange& change) {
  return change.result == ChangeClass::kWorse || change.result == ChangeClass::kBetter;
}

}  // namespace

bool Comparison::has_result() const { return bit_equal > 0 || !changes.empty(); }

ChangeClass Comparison::result() const {
  if (failures == ChangeClass::kWorse) return failures;
  if (pairs > 0 && base_failed == pairs && head_failed == pairs) return ChangeClass::kError;
  ChangeClass worst = failures;
  for (const MissingResult& result : missing) {
    // Without any pair, base and head may be the first builds of different plans.
    if (!missing_allowed && pairs > 0) worst = std::max(worst, result.result);
  }
  if (!has_result() || !unlike.empty()) worst = std::max(worst, ChangeClass::kInconclusive);
  for (const MetricChange& change : changes) {
    if (change.decides) worst = std::max(worst, change.result);
  }
  return worst;
}

std::string count_sentence(const Comparison& comparison) {
  std::string text = fmt::format(
      "{} of runs: {} compared ({} with bit-equal trajectories), {} failed at base, {} at head ({} "
      "newly "
      "failed, {} newly succeeded)",
      counted(comparison.pairs, "pair"), comparison.compared, comparison.bit_equal, comparison.base_failed,
      comparison.head_failed, comparison.newly_failed, comparison.newly_succeeded);
  if (comparison.only_in_base + comparison.only_in_head > 0)
    text += fmt::format("; {} of base and {} of head have no counterpart",
                        counted(comparison.only_in_base, "run"), comparison.only_in_head);
  return text;
}

Comparison compare_runs(std::span<const StoredRun> base, std::span<const StoredRun> head,
                        CompareSource source) {
  const PairedRuns runs = paired_runs(base, head);
  Comparison comparison = counted_outcomes(runs);
  comparison.failures = failure_class(runs);
  comparison.missing = missing_results(runs);
  comparison.unlike = unlike_results(runs);
  const bool trajectories_are_equal = comparison.compared > 0 && comparison.bit_equal == comparison.compared;
  const bool accuracy_is_equal =
      trajectories_are_equal && std::ranges::all_of(runs.pairs, has_equal_accuracy);
  std::vector<MetricSeries> all;
  if (!accuracy_is_equal) all = with_all_pools(accuracy_series(runs));
  for (MetricSeries& series : cost_series(runs)) all.push_back(std::move(series));
  comparison.family = family_of(all);
  comparison.changes = changes_of(all, comparison.family);
  if (accuracy_is_equal) {
    comparison.notes.emplace_back("all trajectories are bit-equal: accuracy was not tested");
  } else if (trajectories_are_equal) {
    comparison.notes.emplace_back(
        "all trajectories are bit-equal, but their errors are not: the ground truth or the evaluation "
        "differs");
  }
  if (std::ranges::any_of(comparison.changes, is_reported_cost))
    comparison.notes.emplace_back(
        "times and memory of runs that share the machine are reported only; measure them with kind = "
        "\"timing\"");
  for (std::string& note : notes_on_copies(runs)) comparison.notes.push_back(std::move(note));
  for (std::string& note : notes_on_pairs(comparison, source)) comparison.notes.push_back(std::move(note));
  return comparison;
}

std::vector<MetricChange> control_changes(std::span<const StoredRun> base) {
  const std::vector<StoredRun> odd = half_of(base, 1);
  const std::vector<StoredRun> even = half_of(base, 0);
  const PairedRuns runs = paired_runs(odd, even);
  std::vector<MetricSeries> list = accuracy_series(runs);
  for (MetricSeries& series : cost_series(runs)) list.push_back(std::move(series));
  return changes_of(list, {.tests = 1});
}

Comparison with_control(Comparison comparison, std::vector<MetricChange> control) {
  for (MetricChange& change : comparison.changes) {
    for (const MetricChange& other : control) {
      if (other.metric != change.metric || other.subject != change.subject || !is_significant(other) ||
          !is_significant(change))
        continue;
      change.result = ChangeClass::kInconclusive;
      comparison.notes.push_back(fmt::format("{} of {} changed by {} between runs of base alone",
                                             change.metric, change.subject,
                                             amount_text(other, other.change.median)));
    }
  }
  comparison.control = std::move(control);
  return comparison;
}

}  // namespace stillpoint::bench
