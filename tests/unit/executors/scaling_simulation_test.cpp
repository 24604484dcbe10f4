// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/distribution.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

constexpr ScalingCosts kExact{.task_start_s = 1.0, .merge_s = 0.5, .prepare_s = 10.0, .variation = 0.0};

TEST(ScalingSimulation, AddsTheTimesOfOneWorker) {
  const std::vector<SimulatedRun> runs = {{4.0, 0}, {4.0, 0}, {8.0, 1}};
  const SimulatedPlan plan = simulate_plan(runs, 1, 1, kExact);
  EXPECT_DOUBLE_EQ(plan.executing_s, 16.0);
  EXPECT_DOUBLE_EQ(plan.starting_s, 1.0);
  EXPECT_DOUBLE_EQ(plan.preparing_s, 20.0);  // two sequences
  EXPECT_DOUBLE_EQ(plan.waiting_s, 0.0);
  EXPECT_DOUBLE_EQ(plan.merging_s, 1.5);
  EXPECT_DOUBLE_EQ(plan.wall_s(), 38.5);
}

TEST(ScalingSimulation, WaitsForTheLastTask) {
  // Tasks {6} and {2}: the workers need 17 s and 13 s.
  const SimulatedPlan plan = simulate_plan(std::vector<SimulatedRun>{{6.0, 0}, {2.0, 0}}, 2, 2, kExact);
  EXPECT_DOUBLE_EQ(plan.executing_s, 4.0);
  EXPECT_DOUBLE_EQ(plan.waiting_s, 2.0);
  EXPECT_DOUBLE_EQ(plan.wall_s(), 18.0);  // 17 s and two runs to merge
}

TEST(ScalingSimulation, PreparesASequenceOncePerWorker) {
  const std::vector<SimulatedRun> runs = repeated(std::vector<SimulatedRun>{{1.0, 0}}, 8);
  ASSERT_EQ(runs.size(), 8u);
  EXPECT_DOUBLE_EQ(simulate_plan(runs, 2, 4, kExact).preparing_s, 10.0);
}

TEST(ScalingSimulation, IsDeterministicAndMoreEfficientForLargerPlans) {
  const std::vector<SimulatedRun> runs(24, SimulatedRun{60.0, 0});
  const ScalingCosts costs;
  const SimulatedPlan small = simulate_plan(runs, 100, 100, costs);
  const SimulatedPlan large = simulate_plan(repeated(runs, 64), 100, 100, costs);
  EXPECT_EQ(small.wall_s(), simulate_plan(runs, 100, 100, costs).wall_s());
  EXPECT_LT(small.efficiency(), 0.24);  // 76 workers have no run
  EXPECT_GT(large.efficiency(), 2.0 * small.efficiency());
}

}  // namespace
}  // namespace stillpoint::bench
