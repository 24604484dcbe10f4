// SPDX-License-Identifier: BSD-3-Clause
#include "bench/compare/comparison.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

/// A change of `median` with an interval of `half_width` to both sides.
MetricChange change_of(double median, double half_width, std::size_t pairs = 10) {
  return {
      .base_median = 1.0,
      .head_median = 1.0 + median,
      .change = {.count = pairs, .median = median, .interval = {median - half_width, median + half_width}},
      .guarded = {median - half_width, median + half_width}};
}

constexpr MetricRule kError{.name = "error", .margin = 0.05};
constexpr MetricRule kRate{.name = "rate", .larger_is_better = true, .margin = 0.05};

TEST(Judge, NeedsBothMarginAndCertaintyForAVerdict) {
  EXPECT_EQ(judge(change_of(0.10, 0.05), kError, true), ChangeVerdict::kWorse);
  EXPECT_EQ(judge(change_of(-0.10, 0.05), kError, true), ChangeVerdict::kBetter);
  EXPECT_EQ(judge(change_of(0.10, 0.15), kError, true), ChangeVerdict::kInconclusive);  // it may be 0
  EXPECT_EQ(judge(change_of(0.02, 0.01), kError, true), ChangeVerdict::kSame);  // certain, and too small
  EXPECT_EQ(judge(change_of(0.04, 0.02), kError, true),
            ChangeVerdict::kInconclusive);  // may be over the margin
}

TEST(Judge, TurnsWithTheDirectionOfTheMetric) {
  EXPECT_EQ(judge(change_of(0.10, 0.05), kRate, true), ChangeVerdict::kBetter);
  EXPECT_EQ(judge(change_of(-0.10, 0.05), kRate, true), ChangeVerdict::kWorse);
}

TEST(Judge, ProvesNothingFromFewPairsOfWhatDiffersByItself) {
  EXPECT_EQ(judge(change_of(0.10, 0.0, 4), kError, false), ChangeVerdict::kInconclusive);
  EXPECT_EQ(judge(change_of(0.10, 0.0, 1), kError, true), ChangeVerdict::kWorse);
  EXPECT_EQ(judge(change_of(0.0, 0.0, 1), kError, false), ChangeVerdict::kSame);
}

TEST(Judge, LeavesDifferencesBelowTheFloorAlone) {
  MetricRule rule = kError;
  rule.floor = 0.2;  // the medians differ by 0.1
  EXPECT_EQ(judge(change_of(0.10, 0.05), rule, true), ChangeVerdict::kSame);
}

StoredRun run_of(const std::string& sequence, double ate, const std::string& trajectory) {
  StoredRun run;
  run.identity = {.variant = "vo", .sequence = sequence};
  run.metrics = {{"ate_rmse_m", "", "m", ate}, {"process_cpu_s", "", "s", 10.0}};
  run.blobs = {{"trajectory", trajectory}};
  return run;
}

TEST(Comparison, JudgesOnlyCostsWhenTrajectoriesAreBitEqual) {
  const std::vector<StoredRun> runs = {run_of("a", 0.01, "t1"), run_of("b", 0.02, "t2")};
  const Comparison comparison = compare_runs(runs, runs);
  EXPECT_EQ(comparison.pairs, 2u);
  EXPECT_EQ(comparison.bit_equal, 2u);
  ASSERT_EQ(comparison.changes.size(), 1u);
  EXPECT_EQ(comparison.changes.front().metric, "process_cpu_s");
  EXPECT_EQ(comparison.verdict(), ChangeVerdict::kSame);
}

TEST(Comparison, DoesNotLetGoodMotionsHideABadOne) {
  const std::vector<StoredRun> base = {run_of("a", 0.01, "1"), run_of("b", 0.02, "2")};
  const std::vector<StoredRun> head = {run_of("a", 0.005, "3"), run_of("b", 0.022, "4")};
  const Comparison comparison = compare_runs(base, head);
  ASSERT_EQ(comparison.changes.size(), 3u);
  EXPECT_EQ(comparison.changes[0].subject, "vo on a");
  EXPECT_EQ(comparison.changes[0].verdict, ChangeVerdict::kBetter);
  EXPECT_EQ(comparison.changes[1].verdict, ChangeVerdict::kWorse);
  EXPECT_EQ(comparison.verdict(), ChangeVerdict::kWorse);
}

TEST(Comparison, WithoutPairsIsInconclusive) {
  EXPECT_EQ(compare_runs({}, {}).verdict(), ChangeVerdict::kInconclusive);
}

TEST(Comparison, DoesNotTrustACostThatChangesByItself) {
  MetricChange slower = change_of(0.10, 0.01);
  slower.metric = "feature_tracking";
  slower.verdict = ChangeVerdict::kWorse;
  const Comparison measured{.pairs = 10, .changes = {slower}};
  const Comparison result = with_control(measured, {.pairs = 5, .changes = {slower}});
  EXPECT_EQ(result.changes.front().verdict, ChangeVerdict::kInconclusive);
  EXPECT_EQ(result.notes.size(), 1u);
}

}  // namespace
}  // namespace stillpoint
