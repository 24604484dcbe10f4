// SPDX-License-Identifier: BSD-3-Clause
/// Is a change of the program better, the same, or worse? Paired runs, metric by metric.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/compare/metric_rules.h"
#include "bench/store/stored_run.h"
#include "eval/statistics/paired.h"

namespace stillpoint {

enum class ChangeVerdict { kSame, kBetter, kInconclusive, kWorse };

/// "same", "better", "inconclusive" or "worse".
[[nodiscard]] std::string verdict_name(ChangeVerdict verdict);

/// One metric on one subject.
struct MetricChange {
  std::string metric;   ///< name, or the module whose time it is
  std::string subject;  ///< variant, and the sequence where it is judged by itself
  std::string unit;
  double base_median = 0.0;
  double head_median = 0.0;
  RelativeChange change;  ///< with its 95 % interval
  /// Interval at a confidence that all metrics of the family share (Bonferroni): of many metrics some would
  /// seem to change by chance.
  Interval guarded;
  ChangeVerdict verdict = ChangeVerdict::kSame;
};

struct Comparison {
  std::size_t pairs = 0;       ///< runs that both sides have
  std::size_t bit_equal = 0;   ///< of these, with the same trajectory to the last bit
  std::size_t newly_lost = 0;  ///< ended well at base and not at head
  std::size_t newly_won = 0;
  std::vector<MetricChange> changes;
  std::vector<MetricChange> control;  ///< base against itself; empty if that was not run
  std::vector<std::string> notes;     ///< what the verdict does not show, a sentence each

  /// The worst of all: a comparison without pairs is inconclusive.
  [[nodiscard]] ChangeVerdict verdict() const;
};

/// Judges a change by its interval.
/// Worse: the interval lies on the bad side of 0, and the median is at least the margin. Better: likewise.
/// Same: the interval lies within the margin to both sides, or the medians differ by less than the floor.
/// Otherwise inconclusive. Fewer than 5 pairs prove nothing of what differs from run to run.
/// @param repeatable whether the same program gives the same number each time
[[nodiscard]] ChangeVerdict judge(const MetricChange& change, const MetricRule& rule, bool repeatable);

/// Pairs runs that differ in nothing but their build. Accuracy is judged for each sequence by itself, so that
/// one bad motion is not hidden by good ones; where every trajectory is bit-equal it is equal and not judged.
/// Times and memory of a variant are judged over all sequences, instructions for each by itself.
[[nodiscard]] Comparison compare_runs(std::span<const StoredRun> base, std::span<const StoredRun> head);

/// Adds the comparison of base with itself. A cost that changes there by itself cannot be judged: its verdict
/// becomes inconclusive.
[[nodiscard]] Comparison with_control(Comparison comparison, const Comparison& control);

}  // namespace stillpoint
