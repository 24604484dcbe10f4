// SPDX-License-Identifier: BSD-3-Clause
/// Values of the compared metrics over paired runs, and the test that is valid for them.
#pragma once

#include <string>
#include <vector>

#include "bench/analysis/paired_runs.h"
#include "bench/model/metrics.h"
#include "eval/statistics/paired.h"

namespace stillpoint::bench {

enum class ChangeTest {
  kExact,       ///< none: the metric has no noise, each difference is caused by the program (instructions)
  kPairs,       ///< signed-rank test over pairs: times, memory, and accuracy over several inputs
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
  std::vector<eval::Pair> pairs;  ///< one per pair of runs
  std::vector<double> base;       ///< `kReplicates`: one value per replicate
  std::vector<double> head;
  bool decides = true;  ///< false: the result of the comparison is that of `pooled` instead
};

/// Accuracy per variant and sequence, from runs that succeeded. Runs with equal fingerprints count once. With
/// one input, replicates of only one side are used as well.
[[nodiscard]] std::vector<MetricSeries> accuracy_series(const PairedRuns& runs);

/// Times and memory per variant, over all its sequences; instructions per variant and sequence.
[[nodiscard]] std::vector<MetricSeries> cost_series(const PairedRuns& runs);

/// The pairs of several series of one metric and variant as one series of the variant.
[[nodiscard]] MetricSeries pooled(const std::vector<const MetricSeries*>& parts);

/// Whether the series is tested: base and head differ, and not exactly known.
[[nodiscard]] bool is_tested(const MetricSeries& series);

/// Smallest p-value that a tested series can reach with its number of pairs.
[[nodiscard]] double smallest_p_of(const MetricSeries& series);

/// Smallest number of pairs per input with which a series can reach a p-value of `level`.
[[nodiscard]] std::size_t pairs_for(const MetricSeries& series, double level);

}  // namespace stillpoint::bench
