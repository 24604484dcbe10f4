// SPDX-License-Identifier: BSD-3-Clause
// Detection power and false alarm rate of the change detection, on synthetic histories.
#include <algorithm>
#include <iostream>

#include <gtest/gtest.h>

#include "bench/analysis/history_changes.h"
#include "tests/unit/analysis/synthetic_history.h"

namespace stillpoint::bench {
namespace {

constexpr std::size_t kCommitsBeforeStep = 60;  // commits before a step
constexpr std::size_t kMaxDelay = 3;
constexpr int kSeeds = 20;

/// Number of `kSeeds` histories with a step whose only shift is open, lies at most `kMaxDelay` commits from
/// the step, and has the true size within 2 sigma of its interval, given `kMaxDelay` commits of the new
/// level.
int detected_steps(const std::string& metric, double level, double step, double noise) {
  int detected = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    std::mt19937_64 random(static_cast<unsigned>(seed));
    std::vector<double> values;
    append_level(values, kCommitsBeforeStep, level, noise, random);
    append_level(values, kMaxDelay, level * (1.0 + step), noise, random);
    const std::vector<LevelShift> shifts = history_changes(history_of(metric, {values}), {}).shifts;
    if (shifts.size() != 1 || shifts.front().state != ChangeState::kOpen) continue;
    const std::size_t after = shifts.front().after;
    const bool near = after + kMaxDelay >= kCommitsBeforeStep && after <= kCommitsBeforeStep + kMaxDelay;
    const eval::Interval interval = *shifts.front().change->interval;
    detected += near && interval.low <= step + 2.0 * noise && interval.high >= step - 2.0 * noise ? 1 : 0;
  }
  std::cout << metric << ", step of " << 100.0 * step << " %, noise of " << 100.0 * noise
            << " %: " << detected << " of " << kSeeds << " detected with " << kMaxDelay
            << " commits after it\n";
  return detected;
}

TEST(ChangeValidation, DetectsACostStepOfFivePercentWithinThreeCommits) {
  EXPECT_EQ(detected_steps("ms", 4.0, 0.05, 0.005), kSeeds);
  EXPECT_EQ(detected_steps("ms", 4.0, 0.05, 0.01), kSeeds);
}

TEST(ChangeValidation, DetectsAnErrorStepOfTenPercentWithinThreeCommits) {
  EXPECT_EQ(detected_steps("ate_rmse_m", 0.02, 0.10, 0.01), kSeeds);
  EXPECT_EQ(detected_steps("ate_rmse_m", 0.02, 0.10, 0.02), kSeeds);
}

bool is_regression(const LevelShift& shift) {
  return shift.state == ChangeState::kOpen || shift.state == ChangeState::kResolved;
}

std::size_t regressions(const HistoryChanges& changes) {
  return static_cast<std::size_t>(std::count_if(changes.shifts.begin(), changes.shifts.end(), is_regression));
}

/// Regressions, open or resolved, in 10 series over 100 commits: 1,000 series-commits.
std::size_t false_alarms(const std::string& metric, double noise, bool heavy, int seed) {
  std::mt19937_64 random(static_cast<unsigned>(1000 * seed));
  std::vector<std::vector<double>> series(10);
  for (std::vector<double>& values : series) append_level(values, 100, 1.0, noise, random, heavy);
  return regressions(history_changes(history_of(metric, series), {}));
}

TEST(ChangeValidation, RaisesAtMostOneFalseAlarmInAThousandSeriesCommits) {
  struct Noise {
    double size;
    bool heavy;
  };
  for (const Noise noise : {Noise{0.01, false}, Noise{0.03, false}, Noise{0.03, true}, Noise{0.10, false}}) {
    std::size_t worst = 0;
    std::size_t sum = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      const std::size_t alarms = false_alarms("ms", noise.size, noise.heavy, seed);
      worst = std::max(worst, alarms);
      sum += alarms;
    }
    std::cout << "null, " << (noise.heavy ? "heavy" : "normal") << " noise of " << 100.0 * noise.size
              << " %: " << sum << " alarms in " << kSeeds << " times 1,000 series-commits, at most " << worst
              << " per 1,000\n";
    EXPECT_LE(worst, 1u);
  }
}

TEST(ChangeValidation, RaisesAtMostOneFalseAlarmIfTestedAfterEachCommit) {
  // As in CI: each of 20 series is tested after each of its commits 51 to 100, 1,000 tests in total.
  std::mt19937_64 random(5);
  std::vector<std::vector<double>> series(20);
  for (std::vector<double>& values : series) append_level(values, 100, 1.0, 0.03, random);
  std::size_t alarms = 0;
  for (const std::vector<double>& values : series) {
    bool was_open = false;
    for (std::size_t commits = 51; commits <= values.size(); ++commits) {
      const std::vector<double> known(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(commits));
      const bool is_open = regressions(history_changes(history_of("ms", {known}), {})) > 0;
      alarms += is_open && !was_open ? 1 : 0;
      was_open = is_open;
    }
  }
  std::cout << "null, tested after each commit: " << alarms << " alarms in 1,000 series-commits\n";
  EXPECT_LE(alarms, 1u);
}

}  // namespace
}  // namespace stillpoint::bench
