// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/comparison.h"

#include <gtest/gtest.h>

#include "tests/support/compared_runs.h"

namespace stillpoint::bench {
namespace {

/// A change of `median` with the interval median +- half_width.
MetricChange change_of(double median, double half_width, double p_value) {
  return {.base_median = 1.0,
          .head_median = 1.0 + median,
          .change = {.count = 10,
                     .median = median,
                     .p_value = p_value,
                     .interval = eval::Interval{median - half_width, median + half_width}},
          .difference = median,
          .difference_interval = eval::Interval{median - half_width, median + half_width},
          .largest = std::abs(median) + half_width};
}

constexpr MetricDescriptor kError{
    .id = "error", .direction = MetricDirection::kSmallerIsBetter, .gate = MetricGate{.margin = 0.05}};
constexpr MetricDescriptor kRate{
    .id = "rate", .direction = MetricDirection::kLargerIsBetter, .gate = MetricGate{.margin = 0.05}};

TEST(Classify, RequiresMarginAndSignificance) {
  EXPECT_EQ(classify(change_of(0.10, 0.05, 0.01), kError), ChangeClass::kWorse);
  EXPECT_EQ(classify(change_of(-0.10, 0.05, 0.01), kError), ChangeClass::kBetter);
  EXPECT_EQ(classify(change_of(0.10, 0.15, 0.2), kError), ChangeClass::kInconclusive);
  EXPECT_EQ(classify(change_of(0.02, 0.01, 0.01), kError),
            ChangeClass::kSame);  // significant, but below the margin
  EXPECT_EQ(classify(change_of(0.04, 0.02, 0.01), kError),
            ChangeClass::kInconclusive);  // the interval contains the margin
}

TEST(Classify, AccountsForTheDirectionOfTheMetric) {
  EXPECT_EQ(classify(change_of(0.10, 0.05, 0.01), kRate), ChangeClass::kBetter);
  EXPECT_EQ(classify(change_of(-0.10, 0.05, 0.01), kRate), ChangeClass::kWorse);
}

TEST(Classify, UsesTheLevelOfTheFamily) {
  MetricChange change = change_of(0.10, 0.05, 0.01);
  change.level = 0.005;
  EXPECT_EQ(classify(change, kError), ChangeClass::kInconclusive);
}

TEST(Classify, ComparesExactCountsWithTheMarginOnly) {
  MetricChange change = change_of(0.10, 0.0, 1.0);
  change.change.count = 1;
  change.test = ChangeTest::kExact;
  EXPECT_EQ(classify(change, kError), ChangeClass::kWorse);
  change.change.median = 0.04;
  EXPECT_EQ(classify(change, kError), ChangeClass::kSame);
}

TEST(Classify, IgnoresDifferencesBelowTheFloor) {
  MetricDescriptor metric = kError;
  metric.gate->floor = 0.2;  // the interval of the difference is 0.05 to 0.15
  EXPECT_EQ(classify(change_of(0.10, 0.05, 0.01), metric), ChangeClass::kSame);
}

TEST(Classify, ADifferenceThatMayExceedTheFloorIsNotTheSame) {
  MetricDescriptor metric = kError;
  metric.gate->floor = 0.2;
  EXPECT_EQ(classify(change_of(0.10, 0.15, 0.01), metric), ChangeClass::kInconclusive);
}

TEST(Classify, WithoutIntervalAChangeIsTheSameWithinTheMarginAndANoisyOneIfItIsNone) {
  MetricChange change = change_of(0.04, 0.0, 1.0);
  change.change.interval.reset();
  EXPECT_EQ(classify(change, kError), ChangeClass::kSame);
  MetricChange noisy = change;
  noisy.is_noisy = true;
  EXPECT_EQ(classify(noisy, kError), ChangeClass::kInconclusive);
  change.largest = 0.06;
  EXPECT_EQ(classify(change, kError), ChangeClass::kInconclusive);
  noisy.largest = 0.0;
  EXPECT_EQ(classify(noisy, kError), ChangeClass::kSame);
}

TEST(Comparison, TestsCostsOnlyIfTrajectoriesAreBitEqual) {
  const std::vector<StoredRun> runs = {compared_run("a", 0.01, 1), compared_run("b", 0.02, 1)};
  const Comparison comparison = compare_runs(runs, runs);
  EXPECT_EQ(comparison.pairs, 2u);
  EXPECT_EQ(comparison.compared, 2u);
  EXPECT_EQ(comparison.bit_equal, 2u);
  ASSERT_EQ(comparison.changes.size(), 1u);
  EXPECT_EQ(comparison.changes.front().metric, "process_cpu_s");
  EXPECT_EQ(comparison.result(), ChangeClass::kSame);
}

TEST(Comparison, WithoutPairsIsInconclusive) {
  const std::vector<StoredRun> runs = {compared_run("a", 0.01, 1)};
  const std::vector<StoredRun> others = {compared_run("b", 0.01, 1)};
  EXPECT_EQ(compare_runs({}, {}).result(), ChangeClass::kInconclusive);
  const Comparison comparison = compare_runs(runs, others);
  EXPECT_EQ(comparison.result(), ChangeClass::kInconclusive);
  EXPECT_EQ(
      count_sentence(comparison),
      "0 pairs of runs: 0 compared (0 with bit-equal trajectories), 0 failed at base, 0 at head (0 newly "
      "failed, 0 newly succeeded); 1 run of base and 1 of head have no counterpart");
  EXPECT_EQ(compare_runs({}, runs).result(), ChangeClass::kInconclusive);
}

TEST(Comparison, WithoutCommonMetricIsInconclusive) {
  StoredRun run = compared_run("a", 0.01, 1);
  run.metrics.clear();
  run.blobs.clear();
  const std::vector<StoredRun> runs = {run};
  EXPECT_EQ(compare_runs(runs, runs).result(), ChangeClass::kInconclusive);
}

TEST(Comparison, IsAnErrorIfAllRunsFailOnBothSides) {
  std::vector<StoredRun> runs = {compared_run("a", 0.01, 1), compared_run("b", 0.01, 1)};
  for (StoredRun& run : runs) run.outcome = Outcome::kCrashed;
  runs.front().detail = "terminated by signal 11";
  const Comparison comparison = compare_runs(runs, runs);
  EXPECT_EQ(comparison.result(), ChangeClass::kError);
  EXPECT_EQ(comparison.base_failed, 2u);
  EXPECT_EQ(comparison.head_failed, 2u);
  EXPECT_EQ(comparison.first_failure, "vo on a, base: crashed, terminated by signal 11");
}

TEST(Comparison, ARunThatFailsOnlyAtHeadIsWorseAndOneThatFailsOnlyAtBaseIsNotCompared) {
  const std::vector<StoredRun> ok = {compared_run("a", 0.01, 1)};
  std::vector<StoredRun> failed = ok;
  failed.front().outcome = Outcome::kLost;
  EXPECT_EQ(compare_runs(ok, failed).result(), ChangeClass::kWorse);
  EXPECT_EQ(compare_runs(failed, ok).result(), ChangeClass::kInconclusive);
}

TEST(Comparison, PairsRunsWithEqualPerturbationsOnly) {
  const std::vector<StoredRun> base = {compared_run("a", 0.01, 1), compared_run("a", 0.011, 2)};
  std::vector<StoredRun> head = {compared_run("a", 0.01, 1, "head")};
  const PairedRuns one = paired_runs(base, head);
  ASSERT_EQ(one.pairs.size(), 1u);
  EXPECT_EQ(one.only_in_base.size(), 1u);
  head.front().identity.config_hash += "-perturbed-9";
  EXPECT_TRUE(paired_runs(base, head).pairs.empty());
}

TEST(Comparison, PairsRunsOfOneNameByTheirConfigIfThereAreSeveral) {
  std::vector<StoredRun> base = {compared_run("a", 0.01, 1), compared_run("a", 0.02, 1)};
  base[0].identity.config_hash = "x";
  base[1].identity.config_hash = "y";
  std::vector<StoredRun> head = {base[1], base[0]};
  const PairedRuns runs = paired_runs(base, head);
  ASSERT_EQ(runs.pairs.size(), 2u);
  EXPECT_EQ(runs.pairs.front().head->identity.config_hash, "x");
  head.pop_back();
  head.front().identity.config_hash = "z";
  EXPECT_TRUE(paired_runs(base, head).pairs.empty());  // "z" may belong to either
}

TEST(Comparison, IsInconclusiveIfTheControlChangesSignificantly) {
  MetricChange slower = change_of(0.10, 0.01, 0.001);
  slower.metric = "feature_tracking";
  slower.result = ChangeClass::kWorse;
  const Comparison measured{.pairs = 10, .compared = 10, .changes = {slower}};
  const Comparison result = with_control(measured, {slower});
  EXPECT_EQ(result.changes.front().result, ChangeClass::kInconclusive);
  EXPECT_EQ(result.notes.size(), 1u);
}

}  // namespace
}  // namespace stillpoint::bench
