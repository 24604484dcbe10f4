// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/run_cost.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

/// A plan of two variants on each of three sequences, and a history with their durations.
struct Example {
  PlanMatrix matrix;
  std::vector<StoredRun> history;
};

Example example() {
  Example example;
  const double seconds[3][2] = {{1.0, 2.0}, {3.0, 9.0}, {4.0, 4.0}};
  example.matrix.sequences.resize(3);
  for (std::size_t sequence = 0; sequence < 3; ++sequence) {
    for (std::size_t variant = 0; variant < 2; ++variant) {
      const RunIdentity identity{.variant = std::to_string(variant), .sequence_id = std::to_string(sequence)};
      example.matrix.runs.push_back({.sequence = sequence, .identity = identity});
      example.history.push_back(
          {.identity = identity, .metrics = {{"process_wall_s", "", "s", seconds[sequence][variant]}}});
    }
  }
  return example;
}

TEST(RunOrder, TheSequenceWithTheLongestRunIsFirstAndItsLongestRunToo) {
  const Example plan = example();
  EXPECT_EQ(execution_order(plan.matrix, plan.history, 2), (std::vector<std::size_t>{3, 2, 4, 5, 1, 0}));
}

TEST(RunOrder, WithoutHistoryTheOrderIsThatOfThePlan) {
  EXPECT_EQ(execution_order(example().matrix, {}, 2), (std::vector<std::size_t>{0, 1, 2, 3, 4, 5}));
}

TEST(RunOrder, TimingRunsKeepTheOrderOfThePlan) {
  Example plan = example();
  plan.matrix.plan.kind = RunKind::kTiming;
  EXPECT_EQ(execution_order(plan.matrix, plan.history, 2), (std::vector<std::size_t>{0, 1, 2, 3, 4, 5}));
}

TEST(RunOrder, RunsThatAreExecutedOneAtATimeKeepTheOrderOfThePlan) {
  const Example plan = example();
  EXPECT_EQ(execution_order(plan.matrix, plan.history, 1), (std::vector<std::size_t>{0, 1, 2, 3, 4, 5}));
}

TEST(RunOrder, RunsOfUnavailableSequencesAreLeftOut) {
  Example plan = example();
  plan.matrix.sequences[1].unavailable_reason = "no folder";
  EXPECT_EQ(execution_order(plan.matrix, plan.history, 2), (std::vector<std::size_t>{4, 5, 1, 0}));
}

}  // namespace
}  // namespace stillpoint::bench
