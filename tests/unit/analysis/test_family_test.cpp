// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/metric_change.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stillpoint::bench {
namespace {

TEST(TestFamily, HasBonferronisLevelIfNoChangeIsSignificant) {
  const std::vector<TestedSeries> tests(10, {.p_value = 0.06, .smallest_p = 1e-6});
  EXPECT_EQ(test_family(tests).tests, 10u);
  EXPECT_DOUBLE_EQ(test_family(tests).level, 0.005);
}

TEST(TestFamily, HasALargerLevelIfSeveralChangesSupportEachOther) {
  // p_(3) = 0.0078 <= 3 * 0.05 / 15 = 0.01; one or two of them would need 0.0033 or 0.0067.
  std::vector<TestedSeries> tests(15, {.p_value = 0.5, .smallest_p = 0.0078});
  tests[2].p_value = tests[7].p_value = 0.0078;
  EXPECT_DOUBLE_EQ(test_family(tests).level, 0.05 / 15.0);
  tests[9].p_value = 0.0078;
  EXPECT_DOUBLE_EQ(test_family(tests).level, 0.01);
}

TEST(TestFamily, LeavesOutTestsThatCannotReject) {
  const std::vector<TestedSeries> tests = {{1e-6, 1e-6}, {0.5, 0.02}, {0.0625, 0.0625}, {1.0, 1.0}};
  EXPECT_EQ(test_family(tests).tests, 2u);
  EXPECT_DOUBLE_EQ(test_family(tests).level, 0.025);
  EXPECT_DOUBLE_EQ(test_family({}).level, 0.05);
}

TEST(TestFamily, RankSumReachesTwoOverTheNumberOfArrangements) {
  EXPECT_DOUBLE_EQ(smallest_rank_sum_p(1, 1), 1.0);
  EXPECT_DOUBLE_EQ(smallest_rank_sum_p(4, 4), 2.0 / 70.0);
  EXPECT_DOUBLE_EQ(smallest_rank_sum_p(3, 5), 2.0 / 56.0);
  EXPECT_DOUBLE_EQ(smallest_rank_sum_p(0, 5), 1.0);
  EXPECT_EQ(replicates_for(0.05), 4u);
}

std::vector<RunIdentity> runs_of(int variants, int sequences, int seeds) {
  std::vector<RunIdentity> runs;
  for (int variant = 0; variant < variants; ++variant) {
    for (int sequence = 0; sequence < sequences; ++sequence) {
      for (int seed = 1; seed <= seeds; ++seed)
        runs.push_back(
            {.variant = std::to_string(variant), .sequence = std::to_string(sequence), .seed = seed});
    }
  }
  return runs;
}

TEST(PairsForPlan, AreThoseOfTheLargestTest) {
  // 5 variants, 3 sequences: 5 * 15 + 14 * 5 = 145 tests, p <= 3.4e-4. 2 / C(16, 8) = 1.6e-4, 2 / C(14, 7)
  // = 5.8e-4.
  EXPECT_EQ(pairs_for_plan(runs_of(5, 3, 1)), 8u);
  // 1 variant, 1 sequence: 19 tests, p <= 0.0026: 10 pairs for the costs.
  EXPECT_EQ(pairs_for_plan(runs_of(1, 1, 1)), 10u);
  // 1 variant, 1 sequence, 4 seeds: ceil(10 / 4).
  EXPECT_EQ(pairs_for_plan(runs_of(1, 1, 4)), 3u);
}

TEST(PairsForPlan, IsOneForExactCounts) {
  std::vector<RunIdentity> runs = runs_of(5, 3, 1);
  for (RunIdentity& run : runs) run.kind = "instructions";
  EXPECT_EQ(pairs_for_plan(runs), 1u);
}

}  // namespace
}  // namespace stillpoint::bench
