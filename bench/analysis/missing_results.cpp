// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/missing_results.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "bench/analysis/unlike_results.h"
#include "bench/model/metrics.h"
#include "eval/statistics/rank_tests.h"

namespace stillpoint::bench {
namespace {

constexpr double kMoreOftenLevel = 0.05;

/// How many pairs have something at base, and how many of them lose or gain it.
struct LossCount {
  std::size_t base = 0;
  std::size_t lost = 0;
  std::size_t gained = 0;

  void add(bool at_base, bool at_head) {
    base += at_base ? 1 : 0;
    lost += at_base && !at_head ? 1 : 0;
    gained += !at_base && at_head ? 1 : 0;
  }
  [[nodiscard]] bool is_lost() const { return base > 0 && lost == base && gained == 0; }
};

using Names = std::set<std::string>;

}  // namespace

bool must_exist(const std::string& name) {
  const MetricDescriptor* descriptor = find_metric(without_protocol(name));
  if (descriptor == nullptr) return true;
  const bool is_of_machine =
      descriptor->source == MetricSource::kMachine || descriptor->source == MetricSource::kDevice;
  return !is_of_machine && !(descriptor->gate && descriptor->gate->absent_is_good);
}

namespace {

/// Metrics with a finite value, and timed modules.
Names names_of(const StoredRun& run) {
  Names names;
  for (const Metric& metric : run.metrics) {
    if (must_exist(metric.name) && std::isfinite(metric.value) && impossibility(metric).empty())
      names.insert("metric " + metric.name);
  }
  for (const ModuleCost& cost : run.costs) {
    if (std::isfinite(cost.mean_ms)) names.insert("module " + cost.module);
  }
  return names;
}

/// Counts by name and variant over all sequences, and by name, variant and subject.
struct LossTable {
  std::map<std::pair<std::string, std::string>, LossCount> variants;
  std::map<std::pair<std::string, std::string>, std::pair<std::string, LossCount>> subjects;

  void add(const RunIdentity& identity, const std::string& name, bool at_base, bool at_head) {
    const std::string variant = variant_label(identity);
    variants[{name, variant}].add(at_base, at_head);
    auto& [of_variant, count] = subjects[{name, subject_label(identity)}];
    of_variant = variant;
    count.add(at_base, at_head);
  }
};

/// Poses of most of the frames that the other side locates: an error over the rest is small if the track is
/// lost early, and so few runs show no significant change of their coverages.
void add_poses(const RunPair& pair, LossTable& table) {
  const std::optional<eval::Pair> coverage = comparable_values(pair, metric_id::kCoverage);
  if (!coverage) return;
  const auto [base, head] = *coverage;
  table.add(pair.base->identity, "half of the poses", 2.0 * base >= head, 2.0 * head >= base);
}

LossTable lost_names(const PairedRuns& runs) {
  LossTable table;
  for (const RunPair& pair : runs.pairs) {
    if (!both_succeeded(pair)) continue;
    add_poses(pair, table);
    const Names base = names_of(*pair.base);
    const Names head = names_of(*pair.head);
    Names all = base;
    all.insert(head.begin(), head.end());
    for (const std::string& name : all)
      table.add(pair.base->identity, name, base.contains(name), head.contains(name));
  }
  return table;
}

/// Variants, sequences, and combinations of them.
struct Scopes {
  Names variants;
  Names sequences;
  Names subjects;

  void add(const RunIdentity& identity) {
    variants.insert(variant_label(identity));
    sequences.insert(identity.sequence);
    subjects.insert(subject_label(identity));
  }
};

std::vector<MissingResult> missing_scopes(const PairedRuns& runs) {
  Scopes head;
  for (const RunPair& pair : runs.pairs) head.add(pair.head->identity);
  for (const StoredRun* run : runs.only_in_head) head.add(run->identity);
  std::map<std::pair<std::string, std::string>, std::size_t> counts;
  for (const StoredRun* run : runs.only_in_base) {
    const RunIdentity& identity = run->identity;
    if (!head.sequences.contains(identity.sequence)) {
      ++counts[{"sequence", identity.sequence}];
    } else if (!head.variants.contains(variant_label(identity))) {
      ++counts[{"variant", variant_label(identity)}];
    } else if (!head.subjects.contains(subject_label(identity))) {
      ++counts[{"variant", subject_label(identity)}];
    }
  }
  std::vector<MissingResult> missing;
  missing.reserve(counts.size());
  for (const auto& [name, count] : counts)
    missing.push_back({.what = name.first, .subject = name.second, .base = count});
  return missing;
}

/// Subjects of which head has less than half of the runs of base, with or without a counterpart: those that
/// are there may be the ones that did not fail, or the first ones of an interrupted plan.
std::vector<MissingResult> missing_runs(const PairedRuns& runs) {
  std::map<std::string, MissingResult> counts;
  const auto count_of = [&](const StoredRun& run) -> MissingResult& {
    return counts[subject_label(run.identity)];
  };
  for (const RunPair& pair : runs.pairs) {
    ++count_of(*pair.base).base;
    ++count_of(*pair.head).head;
  }
  for (const StoredRun* run : runs.only_in_base) ++count_of(*run).base;
  for (const StoredRun* run : runs.only_in_head) ++count_of(*run).head;
  std::vector<MissingResult> missing;
  for (auto& [subject, count] : counts) {
    if (count.head == 0 || 2 * count.head >= count.base) continue;  // none: missing_scopes
    missing.push_back({.what = "runs",
                       .subject = subject,
                       .base = count.base,
                       .head = count.head,
                       .result = ChangeClass::kInconclusive});
  }
  return missing;
}

}  // namespace

std::string variant_label(const RunIdentity& identity) {
  if (identity.axis.empty() || identity.axis == kPerturbationKey) return identity.variant;
  return fmt::format("{} {} = {}", identity.variant, identity.axis, identity.axis_value);
}

std::string subject_label(const RunIdentity& identity) {
  return variant_label(identity) + " on " + identity.sequence;
}

ChangeClass loss_class(std::size_t lost, std::size_t gained) {
  if (lost == gained) return ChangeClass::kSame;
  // With all ranks 1, the number of positive signs is binomial.
  const std::vector<std::size_t> ranks(lost + gained, 1);
  const std::size_t smaller = std::min(lost, gained);
  const double p = eval::two_sided_p(eval::sign_distribution(ranks), smaller) / 2.0;
  const bool is_certain = smaller == 0 || p <= kMoreOftenLevel;
  if (lost > gained) return is_certain ? ChangeClass::kMissing : ChangeClass::kInconclusive;
  return is_certain ? ChangeClass::kBetter : ChangeClass::kSame;
}

std::vector<MissingResult> missing_results(const PairedRuns& runs) {
  std::vector<MissingResult> missing = missing_scopes(runs);
  for (MissingResult& few : missing_runs(runs)) missing.push_back(std::move(few));
  const LossTable table = lost_names(runs);
  for (const auto& [key, entry] : table.subjects) {
    const auto& [variant, count] = entry;
    if (count.lost == 0) continue;
    const LossCount& all = table.variants.at({key.first, variant});
    missing.push_back({.what = key.first,
                       .subject = key.second,
                       .base = count.base,
                       .head = count.base - count.lost,
                       .result = count.is_lost() ? ChangeClass::kMissing : loss_class(all.lost, all.gained)});
  }
  std::erase_if(missing, [](const MissingResult& one) { return one.result < ChangeClass::kInconclusive; });
  std::stable_sort(missing.begin(), missing.end(),
                   [](const MissingResult& a, const MissingResult& b) { return a.result > b.result; });
  return missing;
}

ChangeClass failure_class(const PairedRuns& runs) {
  LossTable table;
  for (const RunPair& pair : runs.pairs) {
    table.add(pair.base->identity, "", pair.base->outcome == Outcome::kOk,
              pair.head->outcome == Outcome::kOk);
  }
  ChangeClass worst = ChangeClass::kSame;
  for (const auto& [key, count] : table.variants)
    worst = std::max(worst, loss_class(count.lost, count.gained));
  for (const auto& [key, entry] : table.subjects) {
    if (entry.second.is_lost()) worst = ChangeClass::kMissing;
  }
  return worst == ChangeClass::kMissing ? ChangeClass::kWorse : worst;
}

}  // namespace stillpoint::bench
