// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/history_changes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/analysis/synthetic_history.h"

namespace stillpoint::bench {
namespace {

/// Levels of a cost [ms] with 1 % noise, 30 commits each.
CommitHistory cost_history(const std::vector<double>& levels, std::size_t length = 30) {
  std::mt19937_64 random(1);
  std::vector<double> values;
  for (const double level : levels) append_level(values, length, level, 0.01, random);
  CommitHistory history = history_of("ms", {values});
  history.series.front().metric = "window_solve";
  return history;
}

std::vector<ChangeState> states_of(const HistoryChanges& changes) {
  std::vector<ChangeState> states;
  for (const LevelShift& shift : changes.shifts) states.push_back(shift.state);
  return states;
}
using States = std::vector<ChangeState>;

TEST(HistoryChanges, APersistentCostIncreaseIsOpenWithCommitRangeAndSize) {
  const HistoryChanges changes = history_changes(cost_history({4.0, 4.4}), {});
  ASSERT_EQ(changes.shifts.size(), 1u);
  const LevelShift& shift = changes.shifts.front();
  EXPECT_EQ(shift.state, ChangeState::kOpen);
  EXPECT_EQ(shift.before, 29u);
  EXPECT_EQ(shift.after, 30u);
  EXPECT_NEAR(shift.change->median, 0.10, 0.01);  // medians of 30 values with 1 % noise: 0.2 % each
  // The difference of two means of 30 values with 1 % noise has a standard deviation of 0.28 %: the limits
  // lie about 2 of these from the estimate, and the estimate within 3 of them from the true change.
  EXPECT_NEAR(shift.change->interval->low, 0.10 - 0.0056, 0.0084);
  EXPECT_NEAR(shift.change->interval->high, 0.10 + 0.0056, 0.0084);
}

TEST(HistoryChanges, AFixedRegressionIsResolved) {
  EXPECT_EQ(states_of(history_changes(cost_history({4.0, 4.4, 4.0}), {})),
            (States{ChangeState::kResolved, ChangeState::kImproved}));
}

TEST(HistoryChanges, IgnoresChangesBelowTheMarginOrTheFloor) {
  EXPECT_TRUE(history_changes(cost_history({4.0, 4.08}), {}).shifts.empty());    // 2 %, margin 3 %
  EXPECT_TRUE(history_changes(cost_history({0.05, 0.055}), {}).shifts.empty());  // 5 us, floor 10 us
}

TEST(HistoryChanges, AMetricWithoutGateHasNeutralChanges) {
  CommitHistory history = cost_history({4.0, 4.4});
  history.series.front().gated = nullptr;
  EXPECT_EQ(states_of(history_changes(history, {})), States{ChangeState::kNeutral});
}

TEST(HistoryChanges, AccountForTheDirectionOfTheMetric) {
  CommitHistory history = cost_history({0.8, 0.9});
  history.series.front().gated = gated_metric("correct_rate");
  EXPECT_EQ(states_of(history_changes(history, {})), States{ChangeState::kImproved});
}

TEST(HistoryChanges, AnAcceptedChangeIsNoLongerOpen) {
  const CommitHistory history = cost_history({4.0, 4.4});
  Acceptance acceptance{.commit = "c30", .metric = "window_solve", .reason = "exact solver"};
  const HistoryChanges changes = history_changes(history, std::vector{acceptance});
  EXPECT_EQ(states_of(changes), States{ChangeState::kAccepted});
  EXPECT_EQ(changes.shifts.front().reason, "exact solver");
  // Accepted within 2 commits of the detected one: the minimum segment is 3.
  acceptance.commit = "c32";
  EXPECT_EQ(states_of(history_changes(history, std::vector{acceptance})), States{ChangeState::kAccepted});
}

TEST(HistoryChanges, AnAcceptanceAppliesToMatchingShiftsOnly) {
  const CommitHistory history = cost_history({4.0, 4.4});
  const Acceptance right{.commit = "c30", .metric = "window_solve", .variant = "vo", .sequence = "s0"};
  Acceptance other_commit = right, other_metric = right, other_variant = right, other_sequence = right;
  other_commit.commit = "c33";
  other_metric.metric = "ate_rmse_m";
  other_variant.variant = "stillpoint";
  other_sequence.sequence = "s1";
  EXPECT_EQ(states_of(history_changes(history, std::vector{right})), States{ChangeState::kAccepted});
  const std::vector<Acceptance> others = {other_commit, other_metric, other_variant, other_sequence};
  EXPECT_EQ(states_of(history_changes(history, others)), States{ChangeState::kOpen});
}

TEST(HistoryChanges, ANewFailureIsOpenWithoutATest) {
  const CommitHistory history =
      history_of(std::string(metric_id::kFailedRuns), {{0.0, 0.0, 0.5, 0.5}, {0.5, 0.5}, {0.5, 0.0}});
  const HistoryChanges changes = history_changes(history, {});
  ASSERT_EQ(changes.shifts.size(), 1u);  // the second series always failed, the third one is fixed
  EXPECT_EQ(changes.shifts.front().before, 1u);
  EXPECT_EQ(changes.shifts.front().after, 2u);
  EXPECT_EQ(changes.shifts.front().state, ChangeState::kOpen);
}

TEST(HistoryChanges, ManySmallStepsAreADrift) {
  std::mt19937_64 random(2);
  std::vector<double> values;
  for (int i = 0; i < 60; ++i) append_level(values, 1, 4.0 * (1.0 + 0.002 * i), 0.01, random);
  const HistoryChanges changes = history_changes(history_of("ms", {values}), {});
  ASSERT_EQ(changes.drifts.size(), 1u);
  EXPECT_TRUE(changes.drifts.front().worse);
  EXPECT_NEAR(changes.drifts.front().start, 4.0, 0.04);  // 1 % noise
  EXPECT_NEAR(changes.drifts.front().change, 59 * 0.002, 0.02);
  EXPECT_TRUE(history_changes(cost_history({4.0, 4.4}), {}).drifts.empty());  // a step is not a drift
}

TEST(HistoryChanges, AStepOfADeterministicMetricNeedsSixCommits) {
  const auto states = [](const std::vector<double>& values) {
    return states_of(history_changes(history_of("ate_rmse_m", {values}), {}));
  };
  EXPECT_EQ(states({0.010, 0.010, 0.010, 0.0163, 0.0163, 0.0163}), States{ChangeState::kOpen});
  EXPECT_EQ(states({0.010, 0.010, 0.010, 0.0163, 0.0163}), States{});  // not confirmed yet
  EXPECT_EQ(states({0.010, 0.010, 0.010, 0.0163, 0.0163, 0.0163, 0.010, 0.010, 0.010}),
            (States{ChangeState::kResolved, ChangeState::kImproved}));
  EXPECT_EQ(states({0.010, 0.010, 0.010, 0.0102, 0.0102, 0.0102}), States{});    // 2 %, margin 5 %
  EXPECT_EQ(states({0.010, 0.0104, 0.0098, 0.0163, 0.0158, 0.0161}), States{});  // noise
}

TEST(HistoryChanges, ADriftIsOpenUntilItIsAccepted) {
  std::vector<double> values;
  for (int i = 0; i < 100; ++i) values.push_back(0.01 * std::pow(1.0039, i));  // +47.6 %
  const CommitHistory history = history_of("ate_rmse_m", {values});
  ASSERT_EQ(history_changes(history, {}).drifts.size(), 1u);
  EXPECT_TRUE(history_changes(history, {}).drifts.front().is_open());
  Acceptance acceptance{.commit = "c99", .metric = "ate_rmse_m", .reason = "more robust"};
  EXPECT_FALSE(history_changes(history, std::vector{acceptance}).drifts.front().is_open());
  acceptance.commit = "c10";  // most of it came later
  EXPECT_TRUE(history_changes(history, std::vector{acceptance}).drifts.front().is_open());
}

TEST(HistoryChanges, AreDeterministic) {
  const CommitHistory history = cost_history({4.0, 4.3, 4.1});
  const HistoryChanges first = history_changes(history, {});
  const HistoryChanges second = history_changes(history, {});
  ASSERT_EQ(first.shifts.size(), second.shifts.size());
  for (std::size_t i = 0; i < first.shifts.size(); ++i) {
    EXPECT_EQ(first.shifts[i].p_value, second.shifts[i].p_value);
    EXPECT_EQ(first.shifts[i].change->interval->low, second.shifts[i].change->interval->low);
  }
}

}  // namespace
}  // namespace stillpoint::bench
