// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/comparison.h"

#include <gtest/gtest.h>

namespace stillpoint::bench {
namespace {

/// A change of `median` with the interval median +- half_width.
MetricChange change_of(double median, double half_width, std::size_t pairs = 10) {
  return {
      .base_median = 1.0,
      .head_median = 1.0 + median,
      .change = {.count = pairs, .median = median, .interval = {median - half_width, median + half_width}},
      .adjusted_interval = {median - half_width, median + half_width}};
}

constexpr MetricDescriptor kError{
    .id = "error", .direction = MetricDirection::kSmallerIsBetter, .gate = MetricGate{.margin = 0.05}};
constexpr MetricDescriptor kRate{
    .id = "rate", .direction = MetricDirection::kLargerIsBetter, .gate = MetricGate{.margin = 0.05}};

TEST(Classify, RequiresMarginAndSignificance) {
  EXPECT_EQ(classify(change_of(0.10, 0.05), kError, true), ChangeClass::kWorse);
  EXPECT_EQ(classify(change_of(-0.10, 0.05), kError, true), ChangeClass::kBetter);
  EXPECT_EQ(classify(change_of(0.10, 0.15), kError, true),
            ChangeClass::kInconclusive);  // the interval contains 0
  EXPECT_EQ(classify(change_of(0.02, 0.01), kError, true),
            ChangeClass::kSame);  // significant, but below the margin
  EXPECT_EQ(classify(change_of(0.04, 0.02), kError, true),
            ChangeClass::kInconclusive);  // the interval contains the margin
}

TEST(Classify, AccountsForTheDirectionOfTheMetric) {
  EXPECT_EQ(classify(change_of(0.10, 0.05), kRate, true), ChangeClass::kBetter);
  EXPECT_EQ(classify(change_of(-0.10, 0.05), kRate, true), ChangeClass::kWorse);
}

TEST(Classify, IsInconclusiveForFewPairsOfANonRepeatableMetric) {
  EXPECT_EQ(classify(change_of(0.10, 0.0, 4), kError, false), ChangeClass::kInconclusive);
  EXPECT_EQ(classify(change_of(0.10, 0.0, 1), kError, true), ChangeClass::kWorse);
  EXPECT_EQ(classify(change_of(0.0, 0.0, 1), kError, false), ChangeClass::kSame);
}

TEST(Classify, IgnoresDifferencesBelowTheFloor) {
  MetricDescriptor metric = kError;
  metric.gate->floor = 0.2;  // the medians differ by 0.1
  EXPECT_EQ(classify(change_of(0.10, 0.05), metric, true), ChangeClass::kSame);
}

StoredRun run_of(const std::string& sequence, double ate, const std::string& trajectory) {
  StoredRun run;
  run.identity = {.variant = "vo", .sequence = sequence};
  run.metrics = {{"ate_rmse_m", "", "m", ate}, {"process_cpu_s", "", "s", 10.0}};
  run.blobs = {{"trajectory", trajectory}};
  return run;
}

TEST(Comparison, TestsCostsOnlyIfTrajectoriesAreBitEqual) {
  const std::vector<StoredRun> runs = {run_of("a", 0.01, "t1"), run_of("b", 0.02, "t2")};
  const Comparison comparison = compare_runs(runs, runs);
  EXPECT_EQ(comparison.pairs, 2u);
  EXPECT_EQ(comparison.bit_equal, 2u);
  ASSERT_EQ(comparison.changes.size(), 1u);
  EXPECT_EQ(comparison.changes.front().metric, "process_cpu_s");
  EXPECT_EQ(comparison.result(), ChangeClass::kSame);
}

TEST(Comparison, DoesNotMaskARegressionOnOneSequence) {
  const std::vector<StoredRun> base = {run_of("a", 0.01, "1"), run_of("b", 0.02, "2")};
  const std::vector<StoredRun> head = {run_of("a", 0.005, "3"), run_of("b", 0.022, "4")};
  const Comparison comparison = compare_runs(base, head);
  ASSERT_EQ(comparison.changes.size(), 3u);
  EXPECT_EQ(comparison.changes[0].subject, "vo on a");
  EXPECT_EQ(comparison.changes[0].result, ChangeClass::kBetter);
  EXPECT_EQ(comparison.changes[1].result, ChangeClass::kWorse);
  EXPECT_EQ(comparison.result(), ChangeClass::kWorse);
}

TEST(Comparison, WithoutPairsIsInconclusive) {
  EXPECT_EQ(compare_runs({}, {}).result(), ChangeClass::kInconclusive);
}

TEST(Comparison, IsInconclusiveIfTheControlChangesSignificantly) {
  MetricChange slower = change_of(0.10, 0.01);
  slower.metric = "feature_tracking";
  slower.result = ChangeClass::kWorse;
  const Comparison measured{.pairs = 10, .changes = {slower}};
  const Comparison result = with_control(measured, {.pairs = 5, .changes = {slower}});
  EXPECT_EQ(result.changes.front().result, ChangeClass::kInconclusive);
  EXPECT_EQ(result.notes.size(), 1u);
}

}  // namespace
}  // namespace stillpoint::bench
