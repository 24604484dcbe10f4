// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/test_family.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <tuple>

#include "bench/analysis/paired_runs.h"
#include "bench/model/metrics.h"
#include "core/base/module_timings.h"
#include "eval/statistics/signed_rank.h"

namespace stillpoint::bench {
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

TestFamily test_family(std::span<const double> smallest_p) {
  const auto below = [&](double level) {
    return static_cast<std::size_t>(
        std::count_if(smallest_p.begin(), smallest_p.end(), [&](double p) { return p <= level; }));
  };
  TestFamily family{.tests = smallest_p.size()};
  for (std::size_t k = 1; below(family.level) > k;) family.level = kSignificance / static_cast<double>(++k);
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

}  // namespace stillpoint::bench
