// SPDX-License-Identifier: BSD-3-Clause
/// Regression test of a program change: classifies each metric over paired runs of base and head.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/model/metrics.h"
#include "eval/statistics/paired.h"

namespace stillpoint::bench {

enum class ChangeClass { kSame, kBetter, kInconclusive, kWorse };

/// "same", "better", "inconclusive" or "worse".
[[nodiscard]] std::string change_class_name(ChangeClass change_class);

/// Change of one metric on one subject.
struct MetricChange {
  std::string metric;   ///< metric name, or name of the timed module
  std::string subject;  ///< variant, and sequence if tested per sequence
  std::string unit;
  double base_median = 0.0;
  double head_median = 0.0;
  eval::RelativeChange change;  ///< with 95 % confidence interval
  /// Confidence interval at 1 - 0.05 / n, with n tested metrics of the family (Bonferroni correction).
  eval::Interval adjusted_interval;
  ChangeClass result = ChangeClass::kSame;
};

struct Comparison {
  std::size_t pairs = 0;            ///< runs present in both base and head
  std::size_t bit_equal = 0;        ///< pairs with bit-equal trajectories
  std::size_t newly_failed = 0;     ///< succeeded at base, but not at head
  std::size_t newly_succeeded = 0;  ///< the reverse
  std::vector<MetricChange> changes;
  std::vector<MetricChange> control;  ///< base compared with itself; empty if not run
  std::vector<std::string> notes;     ///< remarks, one sentence each

  /// The worst class over all metrics; kWorse if any run newly failed, kInconclusive without pairs.
  [[nodiscard]] ChangeClass result() const;
};

/// Classifies a change by its confidence intervals. With the median relative change m (positive = worse), its
/// 95 % interval [l, u], the Bonferroni-adjusted interval [L, U], and the margin and floor of the metric:
///
///   kSame          |median difference| < floor, or -margin <= l and u <= margin
///   kWorse         L > 0 and m >= margin
///   kBetter        U < 0 and m <= -margin
///   kInconclusive  otherwise, or fewer than 5 pairs of a metric that is not repeatable
///
/// @param metric with a gate
/// @param repeatable whether the same program gives the same value in each run
[[nodiscard]] ChangeClass classify(const MetricChange& change, const MetricDescriptor& metric,
                                   bool repeatable);

/// Compares runs that differ only in their build. Accuracy and instruction counts are tested per sequence, so
/// that a regression on one sequence is not masked by others; times and memory are tested per variant over
/// all sequences. Accuracy is not tested if all trajectories are bit-equal.
[[nodiscard]] Comparison compare_runs(std::span<const StoredRun> base, std::span<const StoredRun> head);

/// Adds the comparison of base with itself as a control. A cost with a significant change in the control is
/// set to inconclusive.
[[nodiscard]] Comparison with_control(Comparison comparison, const Comparison& control);

}  // namespace stillpoint::bench
