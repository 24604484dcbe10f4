// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/store_writer.h"

#include <gtest/gtest.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

constexpr const char* kPoses = "1.000000000 1 2 3 0 0 0 1\n2.000000000 4 5 6 0 0 0 1\n";

RunIdentity identity_of(const std::string& variant) {
  return {.variant = variant, .sequence = "office", .sequence_id = "s1", .config_hash = "c1", .build = "abc"};
}

RunOutcome good_outcome() {
  return {.outcome = Outcome::kOk,
          .metrics = {{"ate_rmse_m", "compat:tum", "m", 0.25}},
          .costs = {{"feature_tracking", "call", 2, 1.5, 1.5, 1.9, 2.0}},
          .attachments = {{"trajectory", kPoses},
                          {"timings", "frame,module,ns,calls\n0,feature_tracking,10,1\n"}},
          .manifest = "{\"seed\": 1}"};
}

/// Leases a run in a child process, which then kills itself.
void acquire_and_die(const std::filesystem::path& file, const RunIdentity& identity) {
  const pid_t child = fork();
  if (child == 0) {
    StoreWriter writer(file);
    static_cast<void>(writer.acquire(identity));
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
}

/// Lets four processes open a store for writing at once. @returns how many fail; -1 without a pipe
int failures_of_writers_at_once(const std::filesystem::path& file) {
  std::array<int, 2> gate{};
  if (pipe(gate.data()) != 0) return -1;
  std::vector<pid_t> children(4);
  for (pid_t& child : children) {
    child = fork();
    if (child != 0) continue;
    close(gate[1]);
    char byte = 0;
    if (read(gate[0], &byte, 1) != 0) _exit(2);  // waits until the parent closes the gate
    try {
      StoreWriter writer(file);
    } catch (const InputError& error) {
      std::fputs(error.what(), stderr);
      _exit(1);
    }
    _exit(0);
  }
  close(gate[0]);
  close(gate[1]);
  int failures = 0;
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    failures += WIFEXITED(status) && WEXITSTATUS(status) == 0 ? 0 : 1;
  }
  return failures;
}

TEST(StoreWriter, ANewFileIsOpenedByManyAtOnce) {
  const TemporaryFolder folder;
  for (int file = 0; file < 50; ++file)
    EXPECT_EQ(failures_of_writers_at_once(folder.path() / (std::to_string(file) + ".sqlite")), 0);
}

TEST(StoreWriter, WritesFilesAheadWhichFinishFinds) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "store.sqlite";
  const BlobFiles blobs(files_folder(file) / "blobs");
  StoreWriter writer(file);
  ASSERT_EQ(writer.acquire(identity_of("vo")), RunLease::kGranted);
  writer.write_files(good_outcome());
  const std::vector<std::string> written = blobs.names();
  EXPECT_EQ(written.size(), 2u);  // trajectory and timings
  EXPECT_TRUE(Store(file).runs().empty());
  writer.finish(identity_of("vo"), good_outcome());
  EXPECT_EQ(blobs.names(), written);
  EXPECT_EQ(Store(file).runs().size(), 1u);
}

TEST(StoreWriter, StoresTheResultsOfARun) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "new" / "store.sqlite";
  {
    StoreWriter writer(file);
    ASSERT_EQ(writer.acquire(identity_of("vo")), RunLease::kGranted);
    writer.finish(identity_of("vo"), good_outcome());
  }
  const Store store(file);
  const std::vector<StoredRun> runs = store.runs();
  ASSERT_EQ(runs.size(), 1u);
  const StoredRun& run = runs.front();
  EXPECT_EQ(run.key, run_key(identity_of("vo")));
  EXPECT_EQ(run.identity.variant, "vo");
  EXPECT_EQ(run.outcome, Outcome::kOk);
  EXPECT_EQ(metric_value(run, "ate_rmse_m"), 0.25);
  EXPECT_EQ(metric_value(run, "coverage"), std::nullopt);
  ASSERT_EQ(run.costs.size(), 1u);
  EXPECT_EQ(run.costs.front().p95_ms, 1.9);
  EXPECT_EQ(store.manifest(run), "{\"seed\": 1}");
  ASSERT_EQ(store.trajectory(run).poses.size(), 2u);
  EXPECT_EQ(store.trajectory(run).poses[1].T_w_f.p.y(), 5.0);
  ASSERT_EQ(store.timing_samples(run).size(), 1u);
  EXPECT_EQ(store.timing_samples(run).front().ns, 10);
}

TEST(StoreWriter, LeasesARunToOneWorkerOnly) {
  const TemporaryFolder folder;
  StoreWriter first(folder.path() / "store.sqlite");
  StoreWriter second(folder.path() / "store.sqlite");
  EXPECT_EQ(first.acquire(identity_of("vo")), RunLease::kGranted);
  EXPECT_EQ(second.acquire(identity_of("vo")), RunLease::kLeasedByOther);
  EXPECT_EQ(second.acquire(identity_of("other")), RunLease::kGranted);
  first.finish(identity_of("vo"), good_outcome());
  EXPECT_EQ(second.acquire(identity_of("vo")), RunLease::kDone);
}

TEST(StoreWriter, LeasesAReleasedRunAgain) {
  const TemporaryFolder folder;
  StoreWriter writer(folder.path() / "store.sqlite");
  EXPECT_EQ(writer.acquire(identity_of("vo")), RunLease::kGranted);
  writer.release(identity_of("vo"));
  EXPECT_EQ(writer.acquire(identity_of("vo")), RunLease::kGranted);
}

TEST(StoreWriter, RevokesTheLeaseOfAKilledWorker) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "store.sqlite";
  acquire_and_die(file, identity_of("vo"));
  EXPECT_EQ(Store(file).unfinished(), 1);
  StoreWriter writer(file);
  EXPECT_EQ(writer.acquire(identity_of("vo")), RunLease::kGranted);
  writer.finish(identity_of("vo"), good_outcome());
  EXPECT_EQ(Store(file).unfinished(), 0);
  EXPECT_EQ(Store(file).runs().size(), 1u);
}

TEST(StoreWriter, RemovesTheFilesOfAKilledWorker) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "store.sqlite";
  acquire_and_die(file, identity_of("vo"));
  const StoreWriter writer(file);
  std::size_t workers = 0;
  for (const auto& entry : std::filesystem::directory_iterator(files_folder(file) / "workers")) {
    workers += entry.is_directory() ? 1 : 0;
  }
  EXPECT_EQ(workers, 1u);  // this one
}

TEST(StoreWriter, RemovesOnlyRunsWithTheGivenOutcomes) {
  const TemporaryFolder folder;
  StoreWriter writer(folder.path() / "store.sqlite");
  for (const char* variant : {"a", "b"}) static_cast<void>(writer.acquire(identity_of(variant)));
  writer.finish(identity_of("a"), good_outcome());
  writer.finish(identity_of("b"), {.outcome = Outcome::kCrashed, .detail = "signal 11"});
  writer.remove_runs({run_key(identity_of("a")), run_key(identity_of("b"))}, {Outcome::kCrashed});
  EXPECT_TRUE(writer.is_done(run_key(identity_of("a"))));
  EXPECT_FALSE(writer.is_done(run_key(identity_of("b"))));
}

TEST(StoreWriter, PreservesTheOrderOfAPlan) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "store.sqlite";
  StoreWriter writer(file);
  for (const char* variant : {"a", "b"}) {
    static_cast<void>(writer.acquire(identity_of(variant)));
    writer.finish(identity_of(variant), good_outcome());
  }
  const std::string a = run_key(identity_of("a"));
  const std::string b = run_key(identity_of("b"));
  writer.record_plan({.name = "quick", .title = "Quick", .text = "", .run_keys = {b, "not executed yet", a}});
  const std::vector<StoredRun> runs = Store(file).plan_runs("quick");
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].key, b);
  EXPECT_EQ(runs[1].key, a);
  expect_input_error([&] { static_cast<void>(Store(file).plan_runs("quik")); },
                     {"no plan \"quik\"", "quick"});
}

TEST(Store, SelectsRuns) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "store.sqlite";
  StoreWriter writer(file);
  for (const char* variant : {"a", "b"}) {
    static_cast<void>(writer.acquire(identity_of(variant)));
    writer.finish(identity_of(variant), good_outcome());
  }
  const Store store(file);
  EXPECT_EQ(store.runs({.variant = "b"}).size(), 1u);
  EXPECT_EQ(store.runs({.build = "ab"}).size(), 2u);  // prefix of "abc"
  EXPECT_EQ(store.runs({.build = "abcd"}).size(), 0u);
  EXPECT_EQ(store.runs({.sequence = "kitchen"}).size(), 0u);
}

TEST(RunKey, DependsOnEveryMember) {
  const RunIdentity base = identity_of("vo");
  RunIdentity shifted = base;  // the same concatenation
  shifted.variant = "v";
  shifted.sequence = "ooffice";
  RunIdentity repeated = base;
  repeated.repetition = 2;
  EXPECT_NE(run_key(base), run_key(shifted));
  EXPECT_NE(run_key(base), run_key(repeated));
  EXPECT_EQ(run_key(base), run_key(identity_of("vo")));
}

}  // namespace
}  // namespace stillpoint::bench
