// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/run_cost.h"

#include <gtest/gtest.h>

#include <numeric>

namespace stillpoint::bench {
namespace {

PlanMatrix matrix_of(const std::vector<RunIdentity>& identities) {
  PlanMatrix matrix;
  matrix.sequences.resize(1);
  matrix.sequences[0].rendering = synth::SynthRequest{};
  matrix.sequences[0].rendering->seconds = 10.0;
  matrix.sequences[0].rendering->frames_per_s = 30.0;
  for (const RunIdentity& identity : identities) matrix.runs.push_back({.identity = identity});
  return matrix;
}

StoredRun stored(const RunIdentity& identity, double seconds, double frames) {
  return {.identity = identity,
          .metrics = {{"process_wall_s", "", "s", seconds}, {"frames", "", "", frames}}};
}

RunIdentity identity_of(const std::string& variant, const std::string& sequence) {
  return {.variant = variant, .sequence = sequence, .sequence_id = sequence};
}

TEST(RunCost, TheMostSpecificHistoryIsUsed) {
  const PlanMatrix matrix = matrix_of({identity_of("a", "s"), identity_of("b", "s"), identity_of("a", "t")});
  RunIdentity other_build = identity_of("a", "s");
  other_build.build = "another";
  const std::vector<RunCost> costs =
      expected_costs(matrix, std::vector{stored(other_build, 3.0, 100.0), stored(other_build, 3.0, 100.0)});
  EXPECT_EQ(costs[0].source, CostSource::kSameRun);
  EXPECT_DOUBLE_EQ(costs[0].seconds, 3.0);
  EXPECT_EQ(costs[1].source, CostSource::kSequence);
  EXPECT_DOUBLE_EQ(costs[1].seconds, 3.0);
  EXPECT_EQ(costs[2].source, CostSource::kFrames);
  EXPECT_DOUBLE_EQ(costs[2].seconds, 300 * 3.0 / 100.0);  // 10 s at 30 Hz
}

TEST(RunCost, WithoutHistoryTheCostIsProportionalToTheFrames) {
  PlanMatrix matrix = matrix_of({identity_of("a", "s"), identity_of("a", "s")});
  matrix.runs[1].max_frames = 30;
  const std::vector<RunCost> costs = expected_costs(matrix, {});
  EXPECT_EQ(costs[0].source, CostSource::kAssumed);
  EXPECT_DOUBLE_EQ(costs[0].seconds, 10.0 * costs[1].seconds);
}

TEST(RunCost, FailedRunsAreNotHistory) {
  StoredRun crashed = stored(identity_of("a", "s"), 0.1, 300.0);
  crashed.outcome = Outcome::kCrashed;
  EXPECT_EQ(expected_costs(matrix_of({identity_of("a", "s")}), std::vector{crashed})[0].source,
            CostSource::kAssumed);
}

TEST(RunCost, TheLongestRunFirstAvoidsALastRunAlone) {
  EXPECT_DOUBLE_EQ(scheduled_seconds(std::vector{1.0, 1.0, 1.0, 1.0, 4.0}, 2), 6.0);
  EXPECT_DOUBLE_EQ(scheduled_seconds(std::vector{4.0, 1.0, 1.0, 1.0, 1.0}, 2), 4.0);
  EXPECT_DOUBLE_EQ(scheduled_seconds({}, 2), 0.0);
}

TEST(RunCost, PartsHaveAboutEqualSumsAndNoneIsEmpty) {
  EXPECT_EQ(divide_evenly(std::vector{1.0, 1.0, 1.0, 1.0}, 2), (std::vector<std::size_t>{0, 2, 4}));
  EXPECT_EQ(divide_evenly(std::vector{9.0, 1.0, 1.0, 1.0}, 2), (std::vector<std::size_t>{0, 1, 4}));
  EXPECT_EQ(divide_evenly(std::vector{1.0, 1.0, 9.0}, 3), (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_EQ(divide_evenly(std::vector{1.0, 1.0}, 5), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(divide_evenly(std::vector{0.0, 0.0, 0.0}, 2).size(), 3u);
}

TEST(RunCost, NoPartExceedsTheMeanByMoreThanTheLongestRun) {
  for (int tasks = 1; tasks <= 20; ++tasks) {
    std::vector<double> seconds;
    for (int i = 0; i < 57; ++i) seconds.push_back(1.0 + (i * 7919) % 13);
    const std::vector<std::size_t> bounds = divide_evenly(seconds, tasks);
    ASSERT_EQ(bounds.size(), static_cast<std::size_t>(tasks) + 1);
    const double mean = std::accumulate(seconds.begin(), seconds.end(), 0.0) / tasks;
    for (std::size_t i = 0; i + 1 < bounds.size(); ++i) {
      const double sum = std::accumulate(seconds.begin() + static_cast<std::ptrdiff_t>(bounds[i]),
                                         seconds.begin() + static_cast<std::ptrdiff_t>(bounds[i + 1]), 0.0);
      EXPECT_LE(sum, mean + 13.0) << tasks;
    }
  }
}

}  // namespace
}  // namespace stillpoint::bench
