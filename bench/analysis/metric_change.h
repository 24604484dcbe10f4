// SPDX-License-Identifier: BSD-3-Clause
/// Changes of metrics between the paired runs of two builds: the values of each metric and the test that is
/// valid for them, the level of significance, corrected for the number of tests in one comparison, and size,
/// significance and class of each change.
///
/// A comparison tests many metrics at once: five of accuracy for each variant and sequence, and fourteen of
/// cost for each variant of a timing plan, 150 in all for the plan `quick`. Costs of runs that were not made
/// to measure them (`measures_costs`) are reported, but not tested. The level is that of the false discovery
/// rate (Benjamini and Hochberg, J. R. Statist. Soc. B 57, 1995) at a = 0.05, over the m tests that can
/// reject at all: with n pairs an exact test has no p-value below some p* > 0, and those with p* > a are left
/// out (as in Gilbert, Appl. Statist. 54, 2005; p* depends on the number of pairs and ties only):
///
///   k = max{i: p_(i) <= i a / m},  metric j is significant if p_j <= max(k, 1) a / m
///
/// p_(i): i-th smallest. If nothing changed, the probability of any false statement is at most a (for tests
/// that are independent or positively dependent, as metrics of one run are); if metrics changed, at most a
/// fraction a of the statements is expected to be false. A change shows in several metrics, which support
/// each other: three of 15 metrics need p <= 0.01, where Bonferroni's level is 0.0033, which 8 pairs never
/// reach.
///
/// Smallest p-values: 2^(1-n) for n pairs (signed-rank test), 2 m! n! / (m + n)! for m and n replicates (rank
/// test of two samples). Replicates on one input need fewer runs: for 150 tests 8 per side, where pairs would
/// have to be 13; pairs are better where inputs or the state of the machine differ.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/analysis/paired_runs.h"
#include "bench/model/metrics.h"
#include "bench/model/stored_run.h"
#include "eval/statistics/rank_tests.h"

namespace stillpoint::bench {

/// The test of the change of a metric.
enum class ChangeTest {
  kExact,  ///< none: the metric has no noise, each difference is caused by the program: instructions, and
           ///< accuracy on one input if all repetitions of each side, two or more, are bit-equal
  kPairs,  ///< signed-rank test over pairs: times, memory, and accuracy over several inputs
  kReplicates,  ///< rank test of two samples: accuracy over replicates on one input
};

/// One metric on one subject.
struct MetricSeries {
  std::string metric;   ///< metric name, or name of the timed module
  std::string subject;  ///< variant, and sequence if tested per sequence
  std::string variant;  ///< with the sweep point
  std::string unit;
  const MetricDescriptor* descriptor = nullptr;  ///< with a gate
  ChangeTest test = ChangeTest::kPairs;
  std::size_t inputs = 1;         ///< number of different data and seeds
  std::size_t sequences = 1;      ///< each counted once per variant
  std::size_t repetitions = 0;    ///< that would make it exact if they were bit-equal; 0: none would
  bool is_noisy = false;          ///< two runs of one program may differ by more than rounding
  std::vector<eval::Pair> pairs;  ///< one per pair of runs
  std::vector<double> base;       ///< `kReplicates`: one value per replicate
  std::vector<double> head;
  bool decides = true;  ///< false: reported only; of accuracy, the result is that of `pooled` instead
};

/// Accuracy per variant and sequence, from runs that succeeded. Runs with equal fingerprints count once, also
/// with different seeds. With one input, replicates of only one side are used as well; bit-equal repetitions
/// of both sides (`exact_repetitions`) make the change exact.
[[nodiscard]] std::vector<MetricSeries> accuracy_series(const PairedRuns& runs);

/// Number of bit-equal repetitions of each side from which on a difference is exact. Where they are so by
/// design (`repeats_by_design`), 2 confirm it. Another program may end in one of two results, equally often;
/// r runs of each side are then equal, but differ between the sides, with a probability of 2 / 4^r, more than
/// with any other frequencies. For one of several subjects this happens with at most `kSignificance`.
/// @param run      one of those that are compared
/// @param subjects number of variants and sequences that are compared
[[nodiscard]] std::size_t exact_repetitions(const RunIdentity& run, std::size_t subjects);

/// Times and memory per variant, over all its sequences; instructions per variant and sequence. Those of runs
/// that were not made to measure them do not decide, nor do times that are unlike
/// (bench/analysis/unlike_results.h).
[[nodiscard]] std::vector<MetricSeries> cost_series(const PairedRuns& runs);

/// The pairs of several series of one metric as one series, of one variant or of several.
[[nodiscard]] MetricSeries pooled(const std::vector<const MetricSeries*>& parts);

/// Whether the series is tested: base and head differ, and not exactly known.
[[nodiscard]] bool is_tested(const MetricSeries& series);

/// Largest probability of a false statement in one comparison.
inline constexpr double kSignificance = 0.05;

/// The tests of one comparison.
struct TestFamily {
  std::size_t tests = 0;         ///< m
  std::size_t with_too_few = 0;  ///< tests that were left out, as their number of pairs is too small
  double level = kSignificance;  ///< largest p-value of a significant change
};

/// A test of a comparison.
struct TestedSeries {
  double p_value = 1.0;
  double smallest_p = 1.0;  ///< p*, which its number of pairs can reach
};

[[nodiscard]] TestFamily test_family(std::vector<TestedSeries> tests);

/// Smallest two-sided p-value of the rank test of two samples; 1 if one is empty.
[[nodiscard]] double smallest_rank_sum_p(std::size_t first, std::size_t second);

/// Smallest number of replicates per side whose rank test reaches a p-value of `level`.
/// @param level in (0, 1]
[[nodiscard]] std::size_t replicates_for(double level);

/// Smallest number of pairs per run with which each metric of a plan can be significant.
/// @param runs the runs of one program, without repetitions
/// @return 1 for runs that count instructions, which need no test
[[nodiscard]] std::size_t pairs_for_plan(std::span<const RunIdentity> runs);

/// p-value of the change of a series.
[[nodiscard]] double p_value_of(const MetricSeries& series);

/// Smallest p-value that a tested series can reach with its number of pairs.
[[nodiscard]] double smallest_p_of(const MetricSeries& series);

/// Smallest number of pairs per input with which a series can reach a p-value of `level`.
[[nodiscard]] std::size_t pairs_for(const MetricSeries& series, double level);

/// Smallest number of seeds of each sequence with which a series can reach a p-value of `level`.
[[nodiscard]] std::size_t seeds_for(const MetricSeries& series, double level);

/// From the best to the worst result of a comparison.
enum class ChangeClass { kSame, kBetter, kInconclusive, kMissing, kWorse, kError };

/// "same", "better", "inconclusive", "missing in HEAD", "worse" or "error".
[[nodiscard]] std::string change_class_name(ChangeClass change_class);

/// Change of one metric on one subject.
struct MetricChange {
  std::string metric;   ///< metric name, or name of the timed module
  std::string subject;  ///< variant, and sequence if tested per sequence
  std::string unit;
  double base_median = 0.0;
  double head_median = 0.0;
  eval::RelativeChange
      change;                ///< number of pairs, estimate, p-value, 95 % interval if there are enough pairs
  bool is_absolute = false;  ///< `change` and all intervals are differences in the unit of the metric
  ChangeTest test = ChangeTest::kPairs;
  bool is_noisy = false;         ///< as in `MetricSeries`
  double level = kSignificance;  ///< largest p-value that is significant, see `TestFamily`
  /// Confidence interval at 1 - `level`; nullopt if there are too few pairs for it.
  std::optional<eval::Interval> adjusted_interval{};
  double difference = 0.0;  ///< estimate of head - base, in the unit of the metric, of the tested values
  std::optional<eval::Interval> difference_interval{};  ///< at 95 %; nullopt if there are too few values
  /// Largest absolute change of a pair that differs by at least the floor, relative unless `is_absolute`.
  double largest = 0.0;
  bool changed = false;          ///< by at least margin and floor of the metric, significant or not
  double smallest_p = 1.0;       ///< that the number of pairs can reach
  std::size_t needed = 0;        ///< pairs per input that a class requires; 0 if there are enough
  std::size_t needed_seeds = 0;  ///< seeds of each sequence instead; 0 if there are enough
  std::size_t repetitions = 0;   ///< as in `MetricSeries`
  bool decides = true;  ///< false: reported only, or too few pairs: another change pools all sequences
  ChangeClass result = ChangeClass::kSame;
};

/// "+5.0 %", or "+0.6 s" of an absolute change.
/// @param amount the estimate of a change, or an end of its interval
[[nodiscard]] std::string amount_text(const MetricChange& change, double amount);

/// Classifies a change. With the estimates m of the relative change (positive = worse) and d of the
/// difference in the unit of the metric, the p-value, the 95 % intervals [l, u] of m and [dl, du] of d, and
/// the margin and floor of the metric:
///
///   kWorse         m >= margin, |d| >= floor and p <= level
///   kBetter        m <= -margin, |d| >= floor and p <= level
///   kSame          -margin <= l and u <= margin, or -floor <= dl and du <= floor; without intervals: of the
///                  pairs that differ by the floor or more, none changed (of costs, and of accuracy unless
///                  `repeats_by_design`), or none by more than the margin (accuracy without noise
///                  apart from rounding)
///   kInconclusive  otherwise
///
/// If a value of base is 0 there is no relative change: m, l and u are differences in the unit of the metric,
/// and the margin is max(floor, margin |median of base|). If most runs are equal, m is the difference of the
/// means.
///
/// Instructions and the accuracy of runs with bit-equal repetitions (`ChangeTest::kExact`) are compared with
/// the margin only: each run of a program gives the same, so one pair is sufficient. This is a fact about
/// that input; how far another rounding changes it, perturbed replicates tell.
/// @param metric with a gate
[[nodiscard]] ChangeClass classify(const MetricChange& change, const MetricDescriptor& metric);

/// The changes of the series, sorted by metric and subject. Series without a finite value on both sides are
/// omitted.
/// @param family level of significance; series that do not decide are never better or worse
[[nodiscard]] std::vector<MetricChange> changes_of(const std::vector<MetricSeries>& list,
                                                   const TestFamily& family);

}  // namespace stillpoint::bench
