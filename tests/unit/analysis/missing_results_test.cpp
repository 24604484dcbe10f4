// SPDX-License-Identifier: BSD-3-Clause
// What base has and head lacks is a finding of a comparison.
#include "bench/analysis/missing_results.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "bench/analysis/comparison.h"
#include "tests/support/compared_runs.h"

namespace stillpoint::bench {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// `count` replicates on each of two sequences, with one timed module.
std::vector<StoredRun> two_sequences(int count, const std::string& build) {
  std::vector<StoredRun> runs;
  for (const char* sequence : {"a", "b"}) {
    for (int i = 1; i <= count; ++i) {
      runs.push_back(compared_run(sequence, 0.01 + 1e-5 * i, i, build));
      runs.back().costs = {{.module = "window_solve", .per = "call", .mean_ms = 1.0}};
    }
  }
  return runs;
}

struct MissingSides {
  std::vector<StoredRun> base = two_sequences(20, "base");
  std::vector<StoredRun> head = two_sequences(20, "head");
  [[nodiscard]] Comparison compared() const { return compare_runs(base, head); }
};

TEST(MissingResults, EqualSidesLackNothing) {
  EXPECT_TRUE(MissingSides().compared().missing.empty());
  EXPECT_EQ(MissingSides().compared().result(), ChangeClass::kSame);
}

TEST(MissingResults, ASequenceThatIsRemovedOrRenamedIsAFinding) {
  MissingSides sides;
  for (StoredRun& run : sides.head) {
    if (run.identity.sequence == "b") run.identity.sequence = "c";
  }
  const Comparison comparison = sides.compared();
  ASSERT_EQ(comparison.missing.size(), 1u);
  EXPECT_EQ(comparison.missing.front().what, "sequence");
  EXPECT_EQ(comparison.missing.front().subject, "b");
  EXPECT_EQ(comparison.missing.front().base, 20u);
  EXPECT_EQ(comparison.result(), ChangeClass::kMissing);
}

TEST(MissingResults, AVariantIsNamedOnceOrWithItsSequence) {
  MissingSides sides;
  for (const StoredRun& run : two_sequences(3, "base")) {
    sides.base.push_back(run);
    sides.base.back().identity.variant = "vio";
  }
  ASSERT_EQ(sides.compared().missing.size(), 1u);
  EXPECT_EQ(sides.compared().missing.front().subject, "vio");
  sides.head.insert(sides.head.end(), sides.base.end() - 2, sides.base.end());  // on "b" only
  ASSERT_EQ(sides.compared().missing.size(), 1u);
  EXPECT_EQ(sides.compared().missing.front().subject, "vio on a");
  EXPECT_EQ(sides.compared().result(), ChangeClass::kMissing);
}

TEST(MissingResults, AMetricThatIsRemovedRenamedOrInfiniteIsAFinding) {
  MissingSides removed;
  MissingSides renamed;
  MissingSides infinite;
  for (StoredRun& run : removed.head) run.metrics.erase(run.metrics.begin());
  for (StoredRun& run : renamed.head) run.metrics.front().name = "ate_rmse_cm";
  for (StoredRun& run : infinite.head) run.metrics.front().value = kInfinite;
  for (const MissingSides& sides : {removed, renamed, infinite}) {
    const Comparison comparison = sides.compared();
    ASSERT_EQ(comparison.missing.size(), 2u);
    EXPECT_EQ(comparison.missing.front().what, "metric ate_rmse_m");
    EXPECT_EQ(comparison.missing.front().subject, "vo on a");
    EXPECT_EQ(comparison.missing.front().head, 0u);
    EXPECT_EQ(comparison.result(), ChangeClass::kMissing);
  }
}

TEST(MissingResults, ARenamedModuleIsAFinding) {
  MissingSides sides;
  for (StoredRun& run : sides.head) run.costs.front() = {.module = "solve", .per = "call", .mean_ms = 10.0};
  EXPECT_EQ(sides.compared().missing.front().what, "module window_solve");
  EXPECT_EQ(sides.compared().result(), ChangeClass::kMissing);
}

TEST(MissingResults, AValueThatIsInfiniteMoreOftenThanBeforeIsAFinding) {
  MissingSides sides;
  for (int i = 0; i < 13; ++i) sides.head[static_cast<std::size_t>(i)].metrics.front().value = kInfinite;
  ASSERT_EQ(sides.compared().missing.size(), 1u);
  EXPECT_EQ(sides.compared().missing.front().base, 20u);
  EXPECT_EQ(sides.compared().missing.front().head, 7u);
  EXPECT_EQ(sides.compared().result(), ChangeClass::kMissing);
  // As often at base, in other runs: no finding.
  for (std::size_t i = 20; i < 33; ++i) sides.base[i].metrics.front().value = kInfinite;
  EXPECT_TRUE(sides.compared().missing.empty());
}

TEST(MissingResults, ABaseRunWithoutTheMetricDoesNotHideIt) {
  MissingSides sides;
  sides.base.front().metrics.clear();
  for (StoredRun& run : sides.head) {
    run.metrics.front().value *= 2.0;
    run.blobs["trajectory"] += " of head";
  }
  const Comparison comparison = sides.compared();
  EXPECT_EQ(comparison.result(), ChangeClass::kWorse);
  EXPECT_EQ(std::ranges::count(comparison.changes, "ate_rmse_m", &MetricChange::metric), 2);
}

TEST(MissingResults, EqualTrajectoriesWithOtherErrorsAreNotTheSame) {
  MissingSides sides;
  for (StoredRun& run : sides.head) run.metrics.front().value *= 2.0;
  const Comparison comparison = sides.compared();
  EXPECT_EQ(comparison.bit_equal, 40u);
  EXPECT_EQ(comparison.result(), ChangeClass::kWorse);
  EXPECT_NE(comparison.notes.front().find("the ground truth or the evaluation differs"), std::string::npos);
}

TEST(MissingResults, AFaultThatIsNeverRecoveredFromIsAFindingAndNoWrongPoseIsNone) {
  MissingSides sides;
  for (std::vector<StoredRun>* side : {&sides.base, &sides.head}) {
    for (StoredRun& run : *side)
      run.metrics.insert(run.metrics.end(), {{"time_to_recover_s", "", "s", 0.4}, {"power_w", "", "W", 5.0}});
  }
  for (StoredRun& run : sides.base) run.metrics.push_back({"time_to_detect_s", "", "s", 0.2});
  for (StoredRun& run : sides.head)
    std::erase_if(run.metrics, [](const Metric& metric) { return metric.name == "power_w"; });
  EXPECT_EQ(sides.compared().result(), ChangeClass::kSame);
  for (StoredRun& run : sides.head)
    std::erase_if(run.metrics, [](const Metric& metric) { return metric.name == "time_to_recover_s"; });
  EXPECT_EQ(sides.compared().missing.front().what, "metric time_to_recover_s");
  EXPECT_EQ(sides.compared().result(), ChangeClass::kMissing);
}

// A process can end before its memory is measured.
TEST(MissingResults, ARunWithoutPeakMemoryIsNoFinding) {
  MissingSides sides;
  for (std::vector<StoredRun>* side : {&sides.base, &sides.head}) {
    for (StoredRun& run : *side)
      run.metrics.push_back({.name = "peak_memory_mb", .unit = "MB", .value = 1.7});
  }
  sides.head.front().metrics.pop_back();
  EXPECT_TRUE(sides.compared().missing.empty());
}

TEST(MissingResults, AreNoFindingIfTheyAreAllowed) {
  MissingSides sides;
  for (StoredRun& run : sides.head) run.costs.clear();
  Comparison comparison = sides.compared();
  comparison.missing_allowed = true;
  EXPECT_EQ(comparison.missing.size(), 2u);
  EXPECT_EQ(comparison.result(), ChangeClass::kSame);
}

TEST(MissingResults, FailuresAreWorseIfTheyAreMoreFrequent) {
  MissingSides sides;
  sides.head[3].outcome = Outcome::kCrashed;
  EXPECT_EQ(sides.compared().result(), ChangeClass::kWorse);
  sides.base[30].outcome = Outcome::kCrashed;  // one crash on each side
  EXPECT_EQ(sides.compared().newly_failed, 1u);
  EXPECT_EQ(sides.compared().result(), ChangeClass::kSame);
  sides.head[4].outcome = Outcome::kCrashed;  // 2 against 1: P(B >= 2 of 3) = 0.5
  EXPECT_EQ(sides.compared().result(), ChangeClass::kInconclusive);
  for (std::size_t i = 5; i < 10; ++i) sides.head[i].outcome = Outcome::kCrashed;  // 7 against 1: 9 / 256
  EXPECT_EQ(sides.compared().result(), ChangeClass::kWorse);
}

TEST(MissingResults, ASequenceOnWhichAllRunsFailIsWorseAlsoIfAnotherSucceedsAgain) {
  MissingSides sides;
  for (std::size_t i = 0; i < 20; ++i) sides.head[i].outcome = Outcome::kLost;
  for (std::size_t i = 20; i < 40; ++i) sides.base[i].outcome = Outcome::kLost;
  EXPECT_EQ(sides.compared().result(), ChangeClass::kWorse);
}

TEST(MissingResults, LessThanHalfOfTheRunsOfASequenceIsInconclusive) {
  std::vector<StoredRun> base;
  for (int i = 1; i <= 10; ++i) base.push_back(compared_run("a", 0.01, i));
  const auto result_with = [&](int runs) {
    std::vector<StoredRun> head;
    for (int i = 1; i <= runs; ++i) head.push_back(compared_run("a", 0.01, i, "head"));
    return compare_runs(base, head);
  };
  const Comparison few = result_with(4);
  ASSERT_EQ(few.missing.size(), 1u);
  EXPECT_EQ(few.missing.front().what, "runs");
  EXPECT_EQ(few.missing.front().subject, "vo on a");
  EXPECT_EQ(few.missing.front().base, 10u);
  EXPECT_EQ(few.missing.front().head, 4u);
  EXPECT_EQ(few.result(), ChangeClass::kInconclusive);
  EXPECT_TRUE(result_with(5).missing.empty());
}

TEST(MissingResults, HalfOfThePosesOfOneSequenceIsMissingAlsoBesideManyOthers) {
  std::vector<StoredRun> base;
  for (int i = 0; i < 14; ++i) {
    base.push_back(compared_run("s" + std::to_string(i), 0.01, 1));
    base.back().metrics.push_back({"coverage", "", "", 0.98});
  }
  std::vector<StoredRun> head = base;
  for (StoredRun& run : head) run.identity.build = "head";
  head[3].metrics.back().value = 0.2;
  const Comparison lost = compare_runs(base, head);
  ASSERT_EQ(lost.missing.size(), 1u);
  EXPECT_EQ(lost.missing.front().what, "half of the poses");
  EXPECT_EQ(lost.missing.front().subject, "vo on s3");
  EXPECT_EQ(lost.result(), ChangeClass::kMissing);
  EXPECT_TRUE(compare_runs(head, base).missing.empty());  // gained
  head[3].metrics.back().value = 0.5;
  EXPECT_TRUE(compare_runs(base, head).missing.empty());
}

}  // namespace
}  // namespace stillpoint::bench
