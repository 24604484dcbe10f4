// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/search/bisection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/base/counted.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

/// @param looks see `followed_change`
bool is_changed(const MetricChange& change, std::size_t looks) {
  const bool is_certain =
      change.test == ChangeTest::kExact || static_cast<double>(looks) * change.change.p_value <= change.level;
  return is_certain && change.decides &&
         (change.result == ChangeClass::kWorse || change.result == ChangeClass::kBetter);
}

VersionSide side_of_failures(const Comparison& comparison, double rate) {
  if (comparison.failures == ChangeClass::kWorse) return VersionSide::kAfter;
  const double missed = std::pow(1.0 - rate, static_cast<double>(comparison.pairs));
  const bool is_before = comparison.newly_failed <= comparison.newly_succeeded && missed <= kSignificance;
  return is_before ? VersionSide::kBefore : VersionSide::kUndecided;
}

}  // namespace

std::vector<StoredRun> with_metric_only(std::vector<StoredRun> runs, const std::string& metric) {
  for (StoredRun& run : runs) {
    std::erase_if(run.metrics, [&](const Metric& other) { return other.name != metric; });
    std::erase_if(run.costs, [&](const ModuleCost& other) { return other.module != metric; });
  }
  return runs;
}

std::optional<FollowedChange> followed_change(const Comparison& comparison, const std::string& metric,
                                              std::size_t looks) {
  if (metric == metric_id::kFailedRuns) {
    if (comparison.failures != ChangeClass::kWorse) return std::nullopt;
    return FollowedChange{
        .failures = true,
        .change = {},
        .failure_rate = static_cast<double>(comparison.head_failed) / static_cast<double>(comparison.pairs)};
  }
  std::optional<FollowedChange> largest;
  for (const MetricChange& change : comparison.changes) {
    if (change.metric != metric || !is_changed(change, looks)) continue;
    if (!largest || std::abs(change.change.median) > std::abs(largest->change.change.median))
      largest = FollowedChange{.change = change};
  }
  return largest;
}

VersionSide side_of(const Comparison& comparison, const FollowedChange& whole) {
  if (whole.failures) return side_of_failures(comparison, whole.failure_rate);
  if (comparison.compared == 0) return VersionSide::kUntestable;
  const auto found = std::ranges::find_if(comparison.changes, [&](const MetricChange& change) {
    return change.metric == whole.change.metric && change.subject == whole.change.subject;
  });
  if (found == comparison.changes.end()) {
    const bool is_equal = comparison.bit_equal == comparison.compared;  // then accuracy is not tested
    return is_equal ? VersionSide::kBefore : VersionSide::kUntestable;
  }
  const double half = 0.5 * whole.change.change.median;
  const bool is_exact = found->test == ChangeTest::kExact;
  if (!is_exact && !found->change.interval) return VersionSide::kUndecided;
  const double median = found->change.median;
  const eval::Interval interval = is_exact ? eval::Interval{median, median} : *found->change.interval;
  const double sign = half > 0.0 ? 1.0 : -1.0;
  const auto [low, high] = std::minmax({sign * interval.low, sign * interval.high});
  if (low > std::abs(half)) return VersionSide::kAfter;
  return high < std::abs(half) ? VersionSide::kBefore : VersionSide::kUndecided;
}

std::string change_text(const Comparison& comparison, const FollowedChange& followed) {
  if (followed.failures)
    return fmt::format("{} -> {} failed of {}", comparison.base_failed, comparison.head_failed,
                       counted(static_cast<std::size_t>(comparison.pairs), "run"));
  const MetricChange& change = followed.change;
  return fmt::format("{:.4g} -> {:.4g} {} ({}) on {}, {}", change.base_median, change.head_median,
                     change.unit, amount_text(change, change.change.median), change.subject,
                     counted(static_cast<std::size_t>(comparison.compared), "pair"));
}

Bisection bisect_versions(std::size_t count, const std::function<VersionSide(std::size_t version)>& side) {
  STILLPOINT_CHECK(count >= 2);
  Bisection result{.last_before = 0, .first_after = count - 1};
  while (true) {
    std::optional<std::size_t> next;
    const std::size_t middle = result.last_before + (result.first_after - result.last_before) / 2;
    const auto distance = [&](std::size_t i) { return i > middle ? i - middle : middle - i; };
    for (std::size_t i = result.last_before + 1; i < result.first_after; ++i) {
      const bool is_left_out = std::ranges::find(result.left_out, i) != result.left_out.end();
      if (!is_left_out && (!next || distance(i) < distance(*next))) next = i;
    }
    if (!next) return result;
    const VersionSide found = side(*next);
    if (found == VersionSide::kBefore) {
      result.last_before = *next;
    } else if (found == VersionSide::kAfter) {
      result.first_after = *next;
    } else {
      result.left_out.push_back(*next);
    }
  }
}

}  // namespace stillpoint::bench
