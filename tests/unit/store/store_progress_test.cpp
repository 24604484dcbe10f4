// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/store_progress.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/store/store_writer.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

using std::chrono::seconds;
using std::chrono::system_clock;

RunIdentity run_of_progress(const std::string& variant) {
  return {.variant = variant, .sequence = "office", .sequence_id = "s1", .config_hash = "c1", .build = "abc"};
}

std::string after(system_clock::time_point start, seconds time) {
  const std::time_t t = system_clock::to_time_t(start + time);
  std::tm utc{};
  gmtime_r(&t, &utc);
  std::string text(20, ' ');
  std::strftime(text.data(), text.size() + 1, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

/// A plan of four runs: two ended 10 and 20 s after `start`, the third is running; and a plan that no worker
/// executes.
std::unique_ptr<StoreWriter> writer_of(const std::filesystem::path& file, system_clock::time_point start) {
  auto writer = std::make_unique<StoreWriter>(file);
  std::vector<std::string> keys;
  for (const char* variant : {"a", "b", "c", "d"}) keys.push_back(run_key(run_of_progress(variant)));
  writer->record_plan({.name = "plan", .title = "Title", .text = "", .run_keys = keys});
  writer->record_plan({.name = "other", .title = "", .text = "", .run_keys = {"ffff"}});
  for (const char* variant : {"a", "b", "c"})
    EXPECT_EQ(writer->acquire(run_of_progress(variant)), RunLease::kGranted);
  writer->finish(run_of_progress("a"), {.outcome = Outcome::kOk,
                                        .metrics = {{"ate_rmse_m", "p", "m", 0.25}},
                                        .ended = after(start, seconds(10))});
  writer->finish(run_of_progress("b"),
                 {.outcome = Outcome::kLost, .detail = "no pose", .ended = after(start, seconds(20))});
  return writer;
}

TEST(StoreProgress, CountsRunsAndPredictsTheRemainingTimeOfExecutedPlans) {
  const TemporaryFolder folder;
  // Times of runs are stored in whole seconds, so that the start is one; the worker starts up to 1 s later.
  const auto start = std::chrono::floor<seconds>(system_clock::now());
  const auto writer = writer_of(folder.path() / "s.sqlite", start);
  const ProgressReader reader(folder.path() / "s.sqlite");
  const StoreProgress progress = reader.read(start + seconds(24), 10);
  EXPECT_EQ(progress.workers, 1U);
  EXPECT_EQ(progress.ended, 2);
  ASSERT_EQ(progress.plans.size(), 2U);
  const PlanProgress& plan = progress.plans[0];
  EXPECT_EQ(plan.name, "plan");  // the executed one is first
  EXPECT_TRUE(plan.is_executed);
  EXPECT_EQ(std::vector({plan.runs, plan.ended, plan.failed}), std::vector<std::int64_t>({4, 2, 1}));
  // Two runs in 19 to 20 s; two are left, since 4 s.
  EXPECT_NEAR(plan.runs_per_s.value(), 0.1, 0.01);
  EXPECT_NEAR(plan.remaining_s.value(), 16.0, 2.0);
  EXPECT_FALSE(progress.plans[1].is_executed);
  EXPECT_FALSE(progress.plans[1].remaining_s);
  ASSERT_EQ(progress.running.size(), 1U);
  EXPECT_EQ(progress.running[0].identity.variant, "c");
  EXPECT_NEAR(progress.running[0].running_s, 24.0, 2.0);
}

TEST(StoreProgress, ListsTheNewestRunsFirstWithTheirMetrics) {
  const TemporaryFolder folder;
  const auto writer = writer_of(folder.path() / "s.sqlite", system_clock::now());
  const ProgressReader reader(folder.path() / "s.sqlite");
  const StoreProgress progress = reader.read(system_clock::now(), 10);
  ASSERT_EQ(progress.newest.size(), 2U);
  EXPECT_EQ(progress.newest[0].identity.variant, "b");
  EXPECT_EQ(progress.newest[0].detail, "no pose");
  EXPECT_EQ(metric_value(progress.newest[1], "ate_rmse_m"), 0.25);
  EXPECT_EQ(reader.read(system_clock::now(), 1).newest.size(), 1U);
}

TEST(StoreProgress, HasNoRateWithoutALiveWorker) {
  const TemporaryFolder folder;
  const auto start = system_clock::now();
  writer_of(folder.path() / "s.sqlite", start).reset();
  const StoreProgress progress = ProgressReader(folder.path() / "s.sqlite").read(start + seconds(24), 10);
  EXPECT_EQ(progress.workers, 0U);
  EXPECT_TRUE(progress.running.empty());
  for (const PlanProgress& plan : progress.plans) {
    EXPECT_FALSE(plan.is_executed) << plan.name;
    EXPECT_FALSE(plan.remaining_s) << plan.name;
  }
  EXPECT_EQ(progress.newest.size(), 2U);
}

TEST(StoreProgress, NoticesChangesOfOtherConnections) {
  const TemporaryFolder folder;
  const auto writer = writer_of(folder.path() / "s.sqlite", system_clock::now());
  ProgressReader reader(folder.path() / "s.sqlite");
  EXPECT_TRUE(reader.has_changed());
  EXPECT_FALSE(reader.has_changed());
  writer->finish(run_of_progress("c"), {.outcome = Outcome::kOk});
  EXPECT_TRUE(reader.has_changed());
  EXPECT_EQ(reader.read(system_clock::now(), 10).ended, 3);
}

TEST(StoreProgress, NoticesThatTheStoreWasRemovedOrReplaced) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "s.sqlite";
  static_cast<void>(writer_of(file, system_clock::now()));
  const ProgressReader reader(file);
  EXPECT_FALSE(reader.is_replaced());
  std::filesystem::rename(file, folder.path() / "old.sqlite");
  EXPECT_TRUE(reader.is_replaced());
  static_cast<void>(writer_of(file, system_clock::now()));
  EXPECT_TRUE(reader.is_replaced());
}

}  // namespace
}  // namespace stillpoint::bench
