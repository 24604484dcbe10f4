// SPDX-License-Identifier: BSD-3-Clause
/// Size, significance and class of the change of one metric.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/analysis/metric_series.h"
#include "bench/analysis/test_family.h"
#include "bench/model/metrics.h"
#include "eval/statistics/paired.h"

namespace stillpoint::bench {

/// From the best to the worst result of a comparison.
enum class ChangeClass { kSame, kBetter, kInconclusive, kWorse, kError };

/// "same", "better", "inconclusive", "worse" or "error".
[[nodiscard]] std::string change_class_name(ChangeClass change_class);

/// Change of one metric on one subject.
struct MetricChange {
  std::string metric;   ///< metric name, or name of the timed module
  std::string subject;  ///< variant, and sequence if tested per sequence
  std::string unit;
  double base_median = 0.0;
  double head_median = 0.0;
  eval::RelativeChange
      change;  ///< number of pairs, estimate, p-value, 95 % interval if there are enough pairs
  ChangeTest test = ChangeTest::kPairs;
  double level = kSignificance;  ///< largest p-value that is significant, see bench/analysis/test_family.h
  /// Confidence interval at 1 - `level`; nullopt if there are too few pairs for it.
  std::optional<eval::Interval> adjusted_interval{};
  double largest = 0.0;     ///< largest absolute relative change of a pair
  bool changed = false;     ///< by at least margin and floor of the metric, significant or not
  double smallest_p = 1.0;  ///< that the number of pairs can reach
  std::size_t needed = 0;   ///< pairs per input that a class requires; 0 if there are enough
  bool decides = true;      ///< false: too few pairs on this sequence, another change pools all sequences
  ChangeClass result = ChangeClass::kSame;
};

/// Classifies a change. With the estimate m of the relative change (positive = worse), its p-value, its 95 %
/// interval [l, u], and the margin and floor of the metric:
///
///   kSame          |difference of the medians| < floor
///   kWorse         m >= margin and p <= level
///   kBetter        m <= -margin and p <= level
///   kSame          -margin <= l and u <= margin; without interval: no pair changed (cost), or no pair
///   changed by
///                  more than the margin (accuracy, which has no noise apart from rounding)
///   kInconclusive  otherwise
///
/// Instructions (`ChangeTest::kExact`) are compared with the margin only: the count of a program is the same
/// in each run, so one pair is sufficient.
/// @param metric with a gate
[[nodiscard]] ChangeClass classify(const MetricChange& change, const MetricDescriptor& metric);

/// The changes of the series, sorted by metric and subject. Series without a relative change, because base is
/// 0, are omitted.
/// @param family level of significance; series that do not decide are never better or worse
[[nodiscard]] std::vector<MetricChange> changes_of(const std::vector<MetricSeries>& list,
                                                   const TestFamily& family);

}  // namespace stillpoint::bench
