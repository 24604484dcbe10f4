// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/commit_history.h"

#include <gtest/gtest.h>

#include <limits>

#include "bench/analysis/history_changes.h"
#include "bench/store/store_writer.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// One run of a history.
struct Entry {
  std::string build;
  double ate = 0.0;
  std::string manifest;
  RunIdentity identity = {};
  Outcome outcome = Outcome::kOk;
  std::vector<Metric> others = {};
};

std::string manifest_of(const std::string& cpu, const std::string& commit = "",
                        const std::string& time = "") {
  return R"({"host": {"cpu": ")" + cpu + R"(", "logical_cpus": 4}, "build": {"git_commit": ")" + commit +
         R"(", "git_time": ")" + time + R"("}})";
}

fs::path store_of(const TemporaryFolder& folder, const std::vector<Entry>& entries) {
  fs::path file = folder.path() / "s.sqlite";
  StoreWriter writer(file);
  StoredPlan plan{.name = "quick", .title = "", .text = "", .run_keys = {}};
  for (const Entry& entry : entries) {
    RunIdentity identity = entry.identity;
    identity.build = entry.build;
    identity.sequence = "office";
    if (identity.variant.empty()) identity.variant = "vo";
    static_cast<void>(writer.acquire(identity));
    std::vector<Metric> metrics = entry.others;
    metrics.push_back({"ate_rmse_m", "r", "m", entry.ate});
    writer.finish(identity, {.outcome = entry.outcome,
                             .metrics = metrics,
                             .costs = {{"window_solve", "call", 3, 1.5, 1.0, 2.0, 3.0}},
                             .manifest = entry.manifest});
    plan.run_keys = {run_key(identity)};
  }
  writer.record_plan(plan);
  return file;
}

const HistorySeries& series_of(const CommitHistory& history, const std::string& metric,
                               std::size_t which = 0) {
  for (const HistorySeries& series : history.series) {
    if (series.metric == metric && which-- == 0) return series;
  }
  throw std::out_of_range(metric);
}

TEST(CommitHistory, OrdersCommitsByCommitTime) {
  const TemporaryFolder folder;
  const Store store(store_of(folder, {{"new", 0.2, manifest_of("A", "bbb", "2026-02-01T00:00:00Z")},
                                      {"old", 0.1, manifest_of("A", "aaa", "2026-01-01T00:00:00Z")}}));
  const CommitHistory history = commit_history(store);
  ASSERT_EQ(history.commits.size(), 2u);
  EXPECT_EQ(history.commits[0].name, "aaa");  // measured last
  EXPECT_EQ(series_of(history, "ate_rmse_m").values, (std::vector<double>{0.1, 0.2}));
}

TEST(CommitHistory, UsesTheFirstRunWithoutACommitTime) {
  const TemporaryFolder folder;
  const Store store(store_of(folder, {{"z", 0.1, manifest_of("A")},
                                      {"a", 0.2, manifest_of("A")},
                                      {"z", 0.1, manifest_of("A"), {.repetition = 2}}}));
  const CommitHistory history = commit_history(store);
  ASSERT_EQ(history.commits.size(), 2u);
  EXPECT_EQ(history.commits[0].name, "z");  // started within one second: ordered by run id
  EXPECT_EQ(history.commits[0].time, store.runs().front().started);
}

TEST(CommitHistory, UsesTheMedianOfRepetitionsPerSeed) {
  const TemporaryFolder folder;
  const Store store(store_of(folder, {{"a", 0.1, manifest_of("A")},
                                      {"a", 0.2, manifest_of("A"), {.repetition = 2}},
                                      {"a", 0.9, manifest_of("A"), {.repetition = 3}},
                                      {"a", 0.4, manifest_of("A"), {.seed = 2}}}));
  const CommitHistory history = commit_history(store);
  EXPECT_EQ(series_of(history, "ate_rmse_m").values, std::vector<double>{0.2});
  EXPECT_EQ(series_of(history, "ate_rmse_m").runs, std::vector<std::size_t>{3});
  EXPECT_EQ(series_of(history, "ate_rmse_m", 1).values, std::vector<double>{0.4});
  EXPECT_EQ(series_of(history, "window_solve").values, std::vector<double>{1.5});
  EXPECT_EQ(series_of(history, "window_solve").unit, "ms");
}

TEST(CommitHistory, SeparatesMachinesAndData) {
  const TemporaryFolder folder;
  const Store store(store_of(folder, {{"a", 0.1, manifest_of("A")},
                                      {"b", 0.2, manifest_of("B")},
                                      {"b", 0.3, manifest_of("B"), {.sequence_id = "other"}}}));
  const CommitHistory history = commit_history(store);
  EXPECT_EQ(series_of(history, "ate_rmse_m", 0).subject.host, "A, 4 processors");
  EXPECT_EQ(series_of(history, "ate_rmse_m", 1).subject.host, "B, 4 processors");
  EXPECT_EQ(series_of(history, "ate_rmse_m", 2).subject.sequence_id, "other");
}

TEST(CommitHistory, MergesRunsOfOneCommitFromDifferentPrograms) {
  const TemporaryFolder folder;
  const Store store(store_of(folder, {{"base-1234", 0.1, manifest_of("A", "aaa")},
                                      {"aaa", 0.3, manifest_of("A", "aaa"), {.repetition = 2}}}));
  const CommitHistory history = commit_history(store);
  ASSERT_EQ(history.commits.size(), 1u);
  EXPECT_EQ(series_of(history, "ate_rmse_m").values, std::vector<double>{0.2});  // median of 0.1 and 0.3
}

TEST(CommitHistory, CountsFailedRunsAndOmitsTheirValues) {
  const TemporaryFolder folder;
  const Store store(
      store_of(folder, {{"a", 0.1, manifest_of("A")}, {"a", 9.0, "", {.repetition = 2}, Outcome::kCrashed}}));
  const CommitHistory history = commit_history(store);
  EXPECT_EQ(series_of(history, std::string(metric_id::kFailedRuns)).values, std::vector<double>{0.5});
  EXPECT_EQ(series_of(history, "ate_rmse_m").values, std::vector<double>{0.1});
}

TEST(CommitHistory, AssignsRunsOfEarlierCommitsToCurrentPlans) {
  const TemporaryFolder folder;
  const Store store(store_of(folder, {{"a", 0.1, manifest_of("A")},
                                      {"a", 0.1, manifest_of("A"), {.variant = "other"}},
                                      {"b", 0.2, manifest_of("A")}}));  // the plan contains this one
  const CommitHistory history = commit_history(store);
  for (const HistorySeries& series : history.series) {
    const std::vector<std::string> plans =
        series.subject.variant == "vo" ? std::vector<std::string>{"quick"} : std::vector<std::string>{};
    EXPECT_EQ(series.plans, plans) << series.metric;
  }
}

TEST(CommitHistory, IsThatOfOneSystem) {
  const TemporaryFolder folder;
  const Store store(store_of(
      folder, {{"a", 0.1, ""}, {"1.0", 0.2, "", {.system = "orb"}}, {"1.1", 0.3, "", {.system = "orb"}}}));
  ASSERT_EQ(commit_history(store).commits.size(), 1u);
  EXPECT_EQ(commit_history(store).commits[0].name, "a");
  const CommitHistory orb = commit_history(store, "orb");
  EXPECT_EQ(orb.system, "orb");
  ASSERT_EQ(orb.commits.size(), 2u);
  EXPECT_EQ(orb.commits[1].name, "1.1");
  expect_input_error([&] { static_cast<void>(commit_history(store, "orbb")); },
                     {"--system", "\"orbb\"", "orb, stillpoint"});
}

TEST(CommitHistory, IsThatOfTheOnlySystem) {
  const TemporaryFolder folder;
  const Store store(store_of(folder, {{"1.0", 0.1, "", {.system = "orb"}}}));
  EXPECT_EQ(commit_history(store).system, "orb");
  EXPECT_EQ(commit_history(store).commits.size(), 1u);
}

/// "metric: why", of the open shifts.
std::vector<std::string> missing_in(const Store& store) {
  const CommitHistory history = commit_history(store);
  std::vector<std::string> found;
  for (const LevelShift& shift : history_changes(history, {}).shifts) {
    EXPECT_EQ(shift.state, ChangeState::kOpen);
    found.push_back(history.series[shift.series].metric + ": " + shift.missing);
  }
  return found;
}
using Found = std::vector<std::string>;

TEST(MissingHistory, AMetricThatTheNewestRunsLackIsOpen) {
  const TemporaryFolder folder;
  const std::vector<Metric> recovered = {{"time_to_recover_s", "", "s", 0.5},
                                         {"time_to_detect_s", "", "s", 0.2}};
  const Store store(store_of(
      folder, {{"a", 0.1, manifest_of("A"), {}, Outcome::kOk, recovered}, {"b", 0.1, manifest_of("A")}}));
  EXPECT_EQ(missing_in(store), (Found{"time_to_recover_s: no value"}));  // nothing to detect is good
}

TEST(MissingHistory, AnErrorThatIsInfiniteInMostRunsHasNoValue) {
  const TemporaryFolder folder;
  const double infinite = std::numeric_limits<double>::infinity();
  const Store store(store_of(folder, {{"a", 0.1, manifest_of("A")},
                                      {"b", infinite, manifest_of("A")},
                                      {"b", infinite, manifest_of("A"), {.repetition = 2}},
                                      {"b", 0.1, manifest_of("A"), {.repetition = 3}}}));
  EXPECT_EQ(missing_in(store), (Found{"ate_rmse_m: no value"}));
}

TEST(MissingHistory, OtherDataUnderOneNameAreSaidOnce) {
  const TemporaryFolder folder;
  const Store store(store_of(folder, {{"a", 0.1, manifest_of("A"), {.sequence_id = "8 s"}},
                                      {"b", 0.9, manifest_of("A"), {.sequence_id = "20 s"}}}));
  EXPECT_EQ(missing_in(store), (Found{"ate_rmse_m: other data"}));
}

TEST(MissingHistory, AVariantThatTheNewestCommitLacksIsOpen) {
  const TemporaryFolder folder;
  const Store store(store_of(folder, {{"a", 0.1, manifest_of("A")},
                                      {"a", 0.1, manifest_of("A"), {.variant = "vio"}},
                                      {"b", 0.1, manifest_of("A")}}));
  EXPECT_EQ(missing_in(store), (Found{"ate_rmse_m: not measured"}));
}

TEST(MissingHistory, AnotherMachineIsNoEndOfTheFirst) {
  const TemporaryFolder folder;
  const Store store(store_of(folder, {{"a", 0.1, manifest_of("A")}, {"b", 0.1, manifest_of("B")}}));
  EXPECT_EQ(missing_in(store), Found{});
}

// A variant that is measured at every second commit was not measured at the last one of the first machine.
TEST(MissingHistory, AVariantThatAnotherMachineMeasuresIsNotMissing) {
  const TemporaryFolder folder;
  const Store store(store_of(folder, {{"a", 0.1, manifest_of("A")},
                                      {"a", 0.1, manifest_of("A"), {.variant = "vio"}},
                                      {"b", 0.1, manifest_of("A")},
                                      {"c", 0.1, manifest_of("B")},
                                      {"c", 0.1, manifest_of("B"), {.variant = "vio"}}}));
  EXPECT_EQ(missing_in(store), Found{});
}

TEST(FindCommit, AcceptsAUniquePrefix) {
  CommitHistory history;
  history.commits = {{"abc1", ""}, {"abd2", ""}, {"abc", ""}};
  EXPECT_EQ(find_commit(history, "abd"), 1u);
  EXPECT_EQ(find_commit(history, "abc"), 2u);  // exact match
  expect_input_error([&] { static_cast<void>(find_commit(history, "ab")); }, {"several"});
  expect_input_error([&] { static_cast<void>(find_commit(history, "f")); }, {"no run", "abc"});
}

}  // namespace
}  // namespace stillpoint::bench
