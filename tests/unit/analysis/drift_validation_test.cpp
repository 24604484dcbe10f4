// SPDX-License-Identifier: BSD-3-Clause
// Slow changes of synthetic histories are drifts and never counted as regressions; steps beside them are.
#include <algorithm>
#include <functional>
#include <iostream>

#include <gtest/gtest.h>

#include "bench/analysis/history_changes.h"
#include "tests/unit/analysis/synthetic_history.h"

namespace stillpoint::bench {
namespace {

constexpr std::size_t kCommits = 100;
constexpr int kSeeds = 10;

/// Relative level at each commit.
using Shape = std::function<double(std::size_t commit)>;

double line(std::size_t i) { return 1.0 + 0.002 * static_cast<double>(i); }
/// Ten steps of 2 %, below the margins of 3 % (times) and 5 % (errors).
double staircase(std::size_t i) { return 1.0 + 0.02 * static_cast<double>(i / 10); }
/// Level for 30 commits, rising by 0.4 % per commit for 40, level for 30.
double ramp(std::size_t i) {
  return 1.0 + 0.004 * static_cast<double>(std::clamp<std::size_t>(i, 30, 70) - 30);
}

HistoryChanges changes_of(const std::string& metric, const Shape& shape, double noise, int seed) {
  std::mt19937_64 random(static_cast<unsigned>(seed));
  const double level = metric == "ms" ? 4.0 : 0.02;
  std::vector<double> values;
  for (std::size_t i = 0; i < kCommits; ++i) append_level(values, 1, level * shape(i), noise, random);
  return history_changes(history_of(metric, {values}), {});
}

bool is_regression(const LevelShift& shift) {
  return shift.state == ChangeState::kOpen || shift.state == ChangeState::kResolved;
}

/// Histories with a regression, and histories with a drift for the worse, of `kSeeds`.
struct Counts {
  int regressed = 0;
  int drifting = 0;
};

Counts counts_of(const std::string& metric, const std::string& name, const Shape& shape, double noise) {
  Counts counts;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const HistoryChanges changes = changes_of(metric, shape, noise, seed);
    counts.regressed += std::any_of(changes.shifts.begin(), changes.shifts.end(), is_regression) ? 1 : 0;
    counts.drifting += changes.drifts.size() == 1 && changes.drifts.front().worse ? 1 : 0;
  }
  std::cout << metric << ", " << name << ", noise of " << 100.0 * noise << " %: " << counts.regressed
            << " counted as regressions, " << counts.drifting << " as drifts, of " << kSeeds << "\n";
  return counts;
}

TEST(DriftValidation, ASlowChangeIsADriftAndNoRegression) {
  int histories = 0;
  int regressed = 0;
  for (const char* metric : {"ms", "ate_rmse_m"}) {
    for (const double noise : {0.003, 0.01, 0.02}) {
      for (const auto& [name, shape] :
           {std::pair<std::string, Shape>{"line", line}, {"staircase", staircase}, {"ramp", ramp}}) {
        const Counts counts = counts_of(metric, name, shape, noise);
        EXPECT_EQ(counts.drifting, kSeeds);
        regressed += counts.regressed;
        histories += kSeeds;
      }
    }
  }
  EXPECT_LE(regressed, histories / 30);  // without the test for a step: almost all
}

TEST(DriftValidation, AStepBesideADriftIsARegression) {
  const auto shape = [](std::size_t i) { return line(i) + (i >= 60 ? 0.12 : 0.0); };
  EXPECT_EQ(counts_of("ms", "line with a step of 12 %", shape, 0.01).regressed, kSeeds);
}

}  // namespace
}  // namespace stillpoint::bench
