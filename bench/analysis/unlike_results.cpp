// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/unlike_results.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/analysis/missing_results.h"

namespace stillpoint::bench {
namespace {

constexpr double kMinFirstFraction = 0.25;

/// Members of an identity without which runs are not paired, by name.
std::map<std::string, std::string> conditions_of(const RunIdentity& identity) {
  return {{"data", identity.sequence_id},
          {"kind", identity.kind},
          {"mode", identity.mode},
          {"cores", identity.cores.empty() ? "all" : identity.cores},
          {"seed", fmt::format("{}", identity.seed)},
          {"repetition", fmt::format("{}", identity.repetition)}};
}

using Values = std::map<std::string, std::set<std::string>>;  // by name of the condition

/// Runs of one scope (variant, sequence, kind, mode, cores) are missing or unlike as a whole.
using Scope = std::tuple<std::string, std::string, std::string, std::string>;

Scope scope_of(const RunIdentity& identity) {
  return {subject_label(identity), identity.kind, identity.mode, identity.cores};
}

std::string listed_values(const std::set<std::string>& values) {
  constexpr std::size_t kMaxValues = 3;
  std::vector<std::string> names(values.begin(), values.end());
  const std::size_t count = names.size();
  if (count > kMaxValues) names.resize(kMaxValues);
  return fmt::format("{}{}", fmt::join(names, ", "), count > kMaxValues ? ", ..." : "");
}

bool is_disjoint(const std::set<std::string>& a, const std::set<std::string>& b) {
  return std::ranges::none_of(a, [&](const std::string& value) { return b.contains(value); });
}

void add_values(Values& values, const RunIdentity& identity) {
  for (const auto& [name, value] : conditions_of(identity)) values[name].insert(value);
}

/// Subjects that both sides have, of which no run of base in one scope has a counterpart.
std::vector<UnlikeResult> unpaired_subjects(const PairedRuns& runs) {
  std::set<Scope> paired;
  for (const RunPair& pair : runs.pairs) paired.insert(scope_of(pair.base->identity));
  std::map<std::string, Values> base;
  std::map<std::string, Values> head;
  for (const StoredRun* run : runs.only_in_base) {
    if (!paired.contains(scope_of(run->identity)))
      add_values(base[subject_label(run->identity)], run->identity);
  }
  for (const StoredRun* run : runs.only_in_head)
    add_values(head[subject_label(run->identity)], run->identity);
  for (const RunPair& pair : runs.pairs)
    add_values(head[subject_label(pair.head->identity)], pair.head->identity);
  std::vector<UnlikeResult> unlike;
  for (const auto& [subject, values] : base) {
    const auto found = head.find(subject);
    if (found == head.end()) continue;  // missing
    const std::size_t count = unlike.size();
    for (const auto& [name, of_base] : values) {
      const std::set<std::string>& of_head = found->second.at(name);
      if (is_disjoint(of_base, of_head))
        unlike.push_back({name, subject, listed_values(of_base), listed_values(of_head)});
    }
    if (unlike.size() == count) unlike.push_back({"combination of data, seeds and kind", subject, "", ""});
  }
  return unlike;
}

const Metric* find_stored(const StoredRun& run, std::string_view name) {
  const auto found = std::ranges::find(run.metrics, name, &Metric::name);
  return found == run.metrics.end() ? nullptr : &*found;
}

bool is_same_measure(const Metric& a, const Metric& b) {
  return a.protocol == b.protocol && a.unit == b.unit;
}

/// The metrics of a pair that have the same measure; null if there are none.
std::pair<const Metric*, const Metric*> same_measure(const RunPair& pair, std::string_view name) {
  for (const Metric& base : pair.base->metrics) {
    if (base.name != name) continue;
    for (const Metric& head : pair.head->metrics) {
      if (head.name == name && is_same_measure(base, head)) return {&base, &head};
    }
  }
  return {nullptr, nullptr};
}

/// The numbers of processed frames, if they differ: errors over a part of the data are other errors. In real
/// time, dropped frames are a result.
std::optional<std::pair<double, double>> unlike_frames(const RunPair& pair) {
  const Metric* base = find_stored(*pair.base, metric_id::kFrames);
  const Metric* head = find_stored(*pair.head, metric_id::kFrames);
  if (base == nullptr || head == nullptr || base->value == head->value) return std::nullopt;
  if (pair.base->identity.mode == "realtime") return std::nullopt;
  return std::pair{base->value, head->value};
}

/// Collects differences, each once.
class UnlikeList {
 public:
  void add(UnlikeResult result) {
    if (keys_.insert({result.what, result.subject}).second) results_.push_back(std::move(result));
  }
  [[nodiscard]] std::vector<UnlikeResult> results() && { return std::move(results_); }

 private:
  std::set<std::pair<std::string, std::string>> keys_;
  std::vector<UnlikeResult> results_;
};

void add_unlike_metrics(UnlikeList& list, const RunPair& pair) {
  const std::string subject = subject_label(pair.base->identity);
  if (const auto frames = unlike_frames(pair))
    list.add({"number of processed frames", subject, fmt::format("{}", frames->first),
              fmt::format("{}", frames->second)});
  for (const Metric& base : pair.base->metrics) {
    const Metric* head = find_stored(*pair.head, base.name);
    if (head == nullptr || same_measure(pair, base.name).first != nullptr) continue;
    const bool is_unit = base.unit != head->unit;
    list.add({(is_unit ? "unit of " : "protocol of ") + base.name, subject,
              is_unit ? base.unit : base.protocol, is_unit ? head->unit : head->protocol});
  }
  for (const ModuleCost& base : pair.base->costs) {
    const auto head = std::ranges::find(pair.head->costs, base.module, &ModuleCost::module);
    if (head != pair.head->costs.end() && head->per != base.per)
      list.add({"unit of module " + base.module, subject, "ms per " + base.per, "ms per " + head->per});
  }
}

std::string span_of_starts(const std::vector<RunPair>& pairs, const StoredRun* RunPair::*side) {
  const auto [first, last] =
      std::ranges::minmax(pairs, {}, [&](const RunPair& pair) { return (pair.*side)->started; });
  return (first.*side)->started + " to " + (last.*side)->started;
}

}  // namespace

bool measures_costs(const RunIdentity& identity) { return identity.kind == "timing"; }

bool is_time(const MetricDescriptor& metric) {
  return metric.gate && !metric.gate->repeatable && (metric.unit == "s" || metric.unit == "ms");
}

bool on_same_machine(const RunPair& pair) {
  return pair.base->machine.empty() || pair.head->machine.empty() || pair.base->machine == pair.head->machine;
}

bool is_interleaved(const std::vector<RunPair>& pairs) {
  double first = 0.0;
  double count = 0.0;
  for (const RunPair& a : pairs) {
    for (const RunPair& b : pairs) {
      const std::string& base = a.base->started;
      const std::string& head = b.head->started;
      if (base.empty() || head.empty()) continue;
      count += 1.0;
      first += base < head ? 1.0 : (base == head ? 0.5 : 0.0);
    }
  }
  return count == 0.0 || (first >= kMinFirstFraction * count && first <= (1.0 - kMinFirstFraction) * count);
}

std::optional<eval::Pair> comparable_values(const RunPair& pair, std::string_view metric) {
  const auto [base, head] = same_measure(pair, metric);
  if (base == nullptr || !std::isfinite(base->value) || !std::isfinite(head->value)) return std::nullopt;
  if (!impossibility(*base).empty() || !impossibility(*head).empty() || unlike_frames(pair))
    return std::nullopt;
  return eval::Pair{base->value, head->value};
}

std::vector<UnlikeResult> unlike_results(const PairedRuns& runs) {
  UnlikeList list;
  for (UnlikeResult& result : unpaired_subjects(runs)) list.add(std::move(result));
  std::map<std::string, std::vector<RunPair>> timed;  // by variant
  for (const RunPair& pair : runs.pairs) {
    if (!both_succeeded(pair)) continue;
    add_unlike_metrics(list, pair);
    const RunIdentity& identity = pair.base->identity;
    if (!measures_costs(identity)) continue;
    if (on_same_machine(pair)) {
      timed[variant_label(identity)].push_back(pair);
    } else {
      list.add({"machine of times", variant_label(identity), pair.base->machine, pair.head->machine});
    }
  }
  for (const auto& [variant, pairs] : timed) {
    if (is_interleaved(pairs)) continue;
    list.add({"order of measurement of times", variant, span_of_starts(pairs, &RunPair::base),
              span_of_starts(pairs, &RunPair::head)});
  }
  return std::move(list).results();
}

}  // namespace stillpoint::bench
