// SPDX-License-Identifier: BSD-3-Clause
// What was not measured alike is listed and not compared.
#include "bench/analysis/unlike_results.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bench/analysis/comparison.h"
#include "tests/support/compared_runs.h"

namespace stillpoint::bench {
namespace {

/// Pairs of timing runs in the order base, head, head, base, one per minute.
struct UnlikeSides {
  std::vector<StoredRun> base;
  std::vector<StoredRun> head;

  explicit UnlikeSides(double head_time = 10.0, int count = 12) {
    int minute = 10;
    for (int i = 1; i <= count; ++i) {
      base.push_back(timed("base", i));
      head.push_back(timed("head", i));
      head.back().metrics[1].value = head_time + 1e-4 * i;
      StoredRun& first = i % 2 == 1 ? base.back() : head.back();
      StoredRun& second = i % 2 == 1 ? head.back() : base.back();
      for (StoredRun* run : {&first, &second}) run->started = fmt::format("2026-01-01T00:{}:00Z", minute++);
    }
  }
  static StoredRun timed(const std::string& build, int repetition) {
    StoredRun run = compared_run("a", 0.01 + 1e-5 * repetition, repetition, build);
    run.identity.kind = "timing";
    run.machine = "A, 2 processors";
    return run;
  }
  [[nodiscard]] Comparison compared() const { return compare_runs(base, head); }
};

void expect_unlike(const UnlikeSides& sides, const std::string& what) {
  const Comparison comparison = sides.compared();
  ASSERT_FALSE(comparison.unlike.empty()) << what;
  EXPECT_EQ(comparison.unlike.front().what, what);
  EXPECT_EQ(comparison.result(), ChangeClass::kInconclusive) << what;
}

TEST(UnlikeResults, PairsThatAreMeasuredAlikeAreCompared) {
  EXPECT_TRUE(UnlikeSides().compared().unlike.empty());
  EXPECT_EQ(UnlikeSides().compared().result(), ChangeClass::kSame);
  EXPECT_EQ(UnlikeSides(10.5).compared().result(), ChangeClass::kWorse);
}

TEST(UnlikeResults, AnotherProtocolOrUnitIsNotCompared) {
  UnlikeSides protocol;
  for (StoredRun& run : protocol.head) run.metrics.front() = {"ate_rmse_m", "strict:sim3", "m", 0.02};
  expect_unlike(protocol, "protocol of ate_rmse_m");
  for (const MetricChange& change : protocol.compared().changes) EXPECT_NE(change.metric, "ate_rmse_m");
  UnlikeSides unit;
  for (StoredRun& run : unit.head) run.metrics.front() = {"ate_rmse_m", "", "cm", 1.0};
  expect_unlike(unit, "unit of ate_rmse_m");
}

TEST(UnlikeResults, AModuleThatIsTimedPerFrameIsNotComparedWithOnePerCall) {
  UnlikeSides sides;
  for (StoredRun& run : sides.base) run.costs = {{.module = "window_solve", .per = "call", .mean_ms = 1.0}};
  for (StoredRun& run : sides.head) run.costs = {{.module = "window_solve", .per = "frame", .mean_ms = 1.0}};
  expect_unlike(sides, "unit of module window_solve");
}

TEST(UnlikeResults, APartOfTheFramesIsNotComparedWithAll) {
  UnlikeSides sides;
  for (StoredRun& run : sides.base) run.metrics.push_back({"frames", "", "", 600.0});
  for (StoredRun& run : sides.head) run.metrics.push_back({"frames", "", "", 300.0});
  for (StoredRun& run : sides.head) run.metrics.front().value *= 3.0;
  expect_unlike(sides, "number of processed frames");
  for (std::vector<StoredRun>* side : {&sides.base, &sides.head}) {
    for (StoredRun& run : *side) run.identity.mode = "realtime";  // a slower program drops frames
  }
  EXPECT_TRUE(sides.compared().unlike.empty());
  EXPECT_EQ(sides.compared().result(), ChangeClass::kWorse);
}

TEST(UnlikeResults, ANegativeErrorIsNoImprovement) {
  UnlikeSides sides;
  for (StoredRun& run : sides.head) run.metrics.front() = {"ate_rmse_m", "", "m", -0.02};
  EXPECT_EQ(sides.compared().result(), ChangeClass::kMissing);
}

TEST(UnlikeResults, OtherDataUnderOneNameIsNotCompared) {
  UnlikeSides sides;
  for (StoredRun& run : sides.head) run.identity.sequence_id = "20 s";
  expect_unlike(sides, "data");
  EXPECT_TRUE(sides.compared().missing.empty());
}

TEST(UnlikeResults, AnotherKindOfRunIsNotCompared) {
  UnlikeSides sides;
  const StoredRun other = sides.base.front();
  for (StoredRun& run : sides.head) run.identity.kind = "accuracy";
  expect_unlike(sides, "kind");
  sides.head = UnlikeSides().head;  // one more kind at base
  sides.base.push_back(other);
  sides.base.back().identity.kind = "accuracy";
  expect_unlike(sides, "kind");
}

TEST(UnlikeResults, TimesOfAnotherMachineAreReportedOnly) {
  UnlikeSides sides(20.0);
  for (StoredRun& run : sides.head) run.machine = "B, 4 processors";
  expect_unlike(sides, "machine of times");
  for (const MetricChange& change : sides.compared().changes)
    EXPECT_FALSE(change.decides && change.metric == "process_cpu_s");
}

TEST(UnlikeResults, TimesOfStoresThatWereMeasuredOneAfterTheOtherAreReportedOnly) {
  UnlikeSides sides(10.5);  // the machine became 5 % slower
  for (StoredRun& run : sides.head) run.started[12] = '9';
  expect_unlike(sides, "order of measurement of times");
}

TEST(UnlikeResults, CostsOfAccuracyRunsAreReportedOnlyAndSaySo) {
  UnlikeSides sides(20.0);
  for (std::vector<StoredRun>* side : {&sides.base, &sides.head}) {
    for (StoredRun& run : *side) run.identity.kind = "accuracy";
  }
  const Comparison comparison = sides.compared();
  EXPECT_EQ(comparison.result(), ChangeClass::kSame);
  EXPECT_TRUE(comparison.unlike.empty());
  ASSERT_FALSE(comparison.changes.empty());
  EXPECT_TRUE(comparison.changes.front().changed);
  EXPECT_TRUE(std::ranges::any_of(comparison.notes, [](const std::string& note) {
    return note.find("kind = \"timing\"") != std::string::npos;
  }));
}

TEST(UnlikeResults, CopiesWithOtherSeedsCountOnceAndAreNamed) {
  UnlikeSides sides;
  for (std::vector<StoredRun>* side : {&sides.base, &sides.head}) {
    for (StoredRun& run : *side) {
      run.identity.seed = run.identity.repetition;
      run.identity.config_hash = fmt::format("config with seed {}", run.identity.seed);
      run.identity.repetition = 1;
      run.blobs["trajectory"] = run.identity.build;
      run.metrics.front().value = run.identity.build == "head" ? 0.02 : 0.01;
    }
  }
  const Comparison comparison = sides.compared();
  const auto ate = std::ranges::find(comparison.changes, "ate_rmse_m", &MetricChange::metric);
  ASSERT_NE(ate, comparison.changes.end());
  EXPECT_EQ(ate->change.count, 1u);
  EXPECT_EQ(ate->result, ChangeClass::kInconclusive);
  EXPECT_TRUE(std::ranges::any_of(comparison.notes, [](const std::string& note) {
    return note.find("11 of 12 runs of head have the result of another seed") != std::string::npos;
  }));
}

TEST(UnlikeResults, AllMetricsOfADeterministicChangeSupportEachOther) {
  // Eight seeds: p = 0.0078 for each of five metrics on three sequences, where 15 tests alone require 0.0033.
  std::vector<StoredRun> base;
  std::vector<StoredRun> head;
  for (const char* sequence : {"a", "b", "c"}) {
    for (int seed = 1; seed <= 8; ++seed) {
      for (std::vector<StoredRun>* side : {&base, &head}) {
        const double factor = side == &head && sequence[0] == 'b' ? 1.63 : 1.0 + 1e-4 * (side == &head);
        StoredRun run = compared_run(sequence, 0.01 * seed * factor, 1, side == &head ? "head" : "base");
        run.identity.seed = seed;
        run.identity.sequence_id += std::to_string(seed);
        run.metrics.push_back({"rpe_trans_rmse_m_per_s", "", "m/s", 0.02 * seed * factor});
        run.metrics.push_back({"rpe_rot_rmse_deg_per_s", "", "deg/s", 0.5 * seed * factor});
        run.metrics.push_back({"correct_rate", "", "", 0.9});
        run.costs = {{.module = "window_solve", .per = "call", .mean_ms = 1.0 + 0.1 * seed * factor}};
        side->push_back(run);
      }
    }
  }
  EXPECT_EQ(compare_runs(base, head).result(), ChangeClass::kWorse);
}

}  // namespace
}  // namespace stillpoint::bench
