// SPDX-License-Identifier: BSD-3-Clause
// The error rate of comparisons, by simulation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bench/analysis/comparison.h"
#include "tests/support/compared_runs.h"

namespace stillpoint::bench {
namespace {

struct Sides {
  std::vector<StoredRun> base;
  std::vector<StoredRun> head;
};

/// A comparison of equal programs: three sequences, two variants, accuracy and times.
/// @param pooled one run for each of `pairs` seeds, instead of `pairs` replicates of one seed
Sides unchanged(std::mt19937_64& random, int pairs, bool pooled) {
  std::normal_distribution<double> spread(0.0, 0.2);  // so that changes exceed the margin
  Sides sides;
  for (const char* variant : {"vo", "vio"}) {
    for (const char* sequence : {"a", "b", "c"}) {
      const int replicates = pooled ? 1 : pairs;
      const int seeds = pooled ? pairs : 1;
      for (int i = 0; i < pairs; ++i) {
        for (std::vector<StoredRun>* side : {&sides.base, &sides.head}) {
          StoredRun run = compared_run(sequence, std::exp(spread(random)), i % replicates + 1);
          run.identity.variant = variant;
          run.identity.kind = "timing";
          run.identity.seed = i % seeds;
          run.blobs["trajectory"] += std::to_string(random());
          run.metrics.push_back({"rpe_trans_rmse_m_per_s", "", "m/s", std::exp(spread(random))});
          run.metrics[1].value = std::exp(spread(random));
          run.costs.push_back({.module = "window_solve", .mean_ms = std::exp(spread(random))});
          side->push_back(run);
        }
      }
    }
  }
  return sides;
}

/// 99 % of the binomial distribution of false alarms lie below the mean plus 2.33 standard deviations.
double largest_count(int comparisons) {
  return comparisons * kSignificance + 2.33 * std::sqrt(comparisons * kSignificance * (1.0 - kSignificance));
}

TEST(FalseAlarms, EqualProgramsAreCalledDifferentInAtMost5PercentOfTheComparisons) {
  constexpr int kComparisons = 300;
  std::mt19937_64 random(7);
  for (const bool pooled : {false, true}) {
    int alarms = 0;
    for (int i = 0; i < kComparisons; ++i) {
      const Sides sides = unchanged(random, 7, pooled);
      const Comparison comparison = compare_runs(sides.base, sides.head);
      alarms +=
          std::any_of(comparison.changes.begin(), comparison.changes.end(), [](const MetricChange& change) {
            return change.result == ChangeClass::kWorse || change.result == ChangeClass::kBetter;
          });
    }
    EXPECT_LE(alarms, largest_count(kComparisons)) << "pooled: " << pooled;
    EXPECT_GT(alarms, 0) << "pooled: " << pooled;  // the tests can reject
  }
}

}  // namespace
}  // namespace stillpoint::bench
