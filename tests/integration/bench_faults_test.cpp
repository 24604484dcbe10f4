// SPDX-License-Identifier: BSD-3-Clause
// Benchmarks with defective plans, data and stores: one error line, and no stored run is lost.
#include <gtest/gtest.h>

#include <fstream>

#include <unistd.h>

#include "bench/store/database.h"
#include "bench/store/schema.h"
#include "bench/store/store.h"
#include "tests/support/rejection.h"
#include "tests/support/sequences/replay_bench.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// A folder with a plan of two runs, and a store that contains them.
struct FilledStore {
  TemporaryFolder folder;
  fs::path plan = write_replay_plan(folder, 1, "");
  fs::path store = folder.path() / "store.sqlite";
  FilledStore() { EXPECT_EQ(replay_bench(folder, plan, store).exit_code, 0); }

  /// The plan with additional runs.
  [[nodiscard]] fs::path longer_plan(int repetitions = 3) const {
    return write_replay_plan(folder, repetitions, "");
  }
};

TEST(BenchFaults, AMalformedPlanIsRejectedBeforeAnyRun) {
  const TemporaryFolder folder;
  const fs::path store = folder.path() / "store.sqlite";
  const fs::path broken = folder.write("broken.toml", "title = \"x\"\nsequences = [\n");
  expect_rejected(replay_bench(folder, broken, store), {"broken.toml:"});
  const fs::path unknown = folder.write("unknown.toml", "repetition = 3\n");
  expect_rejected(replay_bench(folder, unknown, store),
                  {"unknown.toml:1: unknown key \"repetition\"; did you mean \"repetitions\"?"});
  const fs::path wrong = folder.write("wrong.toml", "repetitions = \"many\"\n");
  expect_rejected(replay_bench(folder, wrong, store), {"wrong.toml:1", "repetitions"});
  EXPECT_FALSE(fs::exists(store));
}

TEST(BenchFaults, AnUnknownSequenceIsRejectedBeforeAnyRun) {
  const TemporaryFolder folder;
  const fs::path store = folder.path() / "store.sqlite";
  const fs::path recorded = folder.write("recorded.toml", "[recorded]\nsequences = [\"nowhere\"]\n");
  expect_rejected(replay_bench(folder, recorded, store), {"nowhere"});
  const fs::path rendered = folder.write("rendered.toml", "[rendered]\nsequences = [\"walking_xyy\"]\n");
  expect_rejected(replay_bench(folder, rendered, store), {"walking_xyy"});
  EXPECT_FALSE(fs::exists(store));
}

TEST(BenchFaults, MissingDataAreReportedAndNoStoredRunIsLost) {
  const FilledStore filled;
  const fs::path plan = filled.folder.write(
      "missing.toml",
      "systems = [\"" + (filled.folder.path() / "replay.toml").string() +
          "\"]\nrepetitions = 2\n[recorded]\nsequences = [\"freiburg1_a\", \"freiburg1_b\"]\n");
  fs::remove_all(filled.folder.path() / "freiburg1_b");
  expect_rejected(replay_bench(filled.folder, plan, filled.store), {"freiburg1_b"});
  EXPECT_EQ(bench::Store(filled.store).runs().size(), 2u);
}

TEST(BenchFaults, DataRemovedDuringABenchmarkFailOnlyTheirRuns) {
  const TemporaryFolder folder;
  const fs::path plan = write_replay_plan(folder, 1, "");
  // The system removes the second sequence during its run on the first one.
  folder.write("replay.toml",
               "name = \"deleting\"\nversion = \"1\"\nlayout = \"as_is\"\ncommand = [\"/bin/sh\", \"-c\", "
               "\"rm -rf " +
                   (folder.path() / "freiburg1_b").string() + "; exit 1\"]\n");
  const fs::path store = folder.path() / "store.sqlite";
  const ProgramResult result =
      run_program({"bench", plan.string(), "--store", store.string(), "--out",
                   (folder.path() / "out").string(), "--jobs", "1"},
                  {.environment = {"STILLPOINT_DATA=" + folder.path().string(),
                                   "STILLPOINT_REGISTRY=" + (folder.path() / "none.json").string()}});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  const std::vector<bench::StoredRun> runs = bench::Store(store).runs();
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[1].outcome, bench::Outcome::kBadData);
  EXPECT_NE(runs[1].detail.find("freiburg1_b"), std::string::npos) << runs[1].detail;
}

TEST(BenchFaults, AFullDiskLosesNoStoredRunAndTheNextCallContinues) {
  const FilledStore filled;
  const fs::path plan = filled.longer_plan(60);
  ProgramOptions full;
  full.file_limit_bytes = 120'000;  // exceeded by the store and its log before all runs are executed
  const ProgramResult result = replay_bench(filled.folder, plan, filled.store, full);
  expect_rejected(result, {"free space"});
  const std::size_t stored = bench::Store(filled.store).runs().size();
  EXPECT_GE(stored, 2u);
  EXPECT_LT(stored, 120u);
  EXPECT_EQ(replay_bench(filled.folder, plan, filled.store).exit_code, 0);  // without the limit
  EXPECT_EQ(bench::Store(filled.store).runs().size(), 120u);
}

TEST(BenchFaults, AReadOnlyStoreIsListedAndNotFilled) {
  const FilledStore filled;
  const fs::path plan = filled.longer_plan();
  const ProgramOptions reader{.without_write_access = true};
  fs::permissions(filled.store, fs::perms(0444));
  fs::permissions(filled.folder.path(), fs::perms(0555));
  const ProgramResult list = run_program({"store", "list", "--store", filled.store.string()}, reader);
  const TemporaryFolder out;
  fs::permissions(out.path(), fs::perms::all);
  const ProgramResult result = run_program(
      {"bench", plan.string(), "--store", filled.store.string(), "--out", (out.path() / "out").string()},
      {.environment = {"STILLPOINT_DATA=" + filled.folder.path().string(),
                       "STILLPOINT_REGISTRY=" + (filled.folder.path() / "none.json").string()},
       .without_write_access = true});
  fs::permissions(filled.folder.path(), fs::perms::owner_all);
  if (list.exit_code == 127) GTEST_SKIP() << "another user cannot execute the program in the build folder";
  EXPECT_EQ(list.exit_code, 0) << list.err;
  expect_rejected(result, {"store.sqlite", "Permission denied", "must be writable"});
  EXPECT_EQ(bench::Store(filled.store).runs().size(), 2u);
}

TEST(BenchFaults, AStoreOfANewerVersionIsRejectedByAllCommands) {
  const FilledStore filled;
  bench::Database(filled.store, bench::DatabaseAccess::kWrite)
      .execute("PRAGMA user_version = " + std::to_string(bench::schema_version() + 1));
  const std::string store = filled.store.string();
  expect_rejected(replay_bench(filled.folder, filled.longer_plan(), filled.store), {"newer version"});
  expect_rejected(run_program({"store", "list", "--store", store}), {"newer version"});
  expect_rejected(run_program({"stats", "summary", "--store", store}), {"newer version"});
  expect_rejected(run_program({"compare", store, store}), {"newer version"});
  bench::Database(filled.store, bench::DatabaseAccess::kWrite)
      .execute("PRAGMA user_version = " + std::to_string(bench::schema_version()));
  EXPECT_EQ(bench::Store(filled.store).runs().size(), 2u);  // nothing was changed
}

TEST(BenchFaults, ADamagedStoreIsRejectedAndNotModified) {
  const FilledStore filled;
  {
    std::fstream stream(filled.store, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(4096);  // the second page, which belongs to a table
    stream << std::string(4096, '\xff');
  }
  const auto size = fs::file_size(filled.store);
  expect_rejected(replay_bench(filled.folder, filled.longer_plan(), filled.store),
                  {"store.sqlite", "damaged"});
  EXPECT_EQ(fs::file_size(filled.store), size);
  const fs::path text = filled.folder.write("notes.sqlite", std::string(5000, 'n'));
  expect_rejected(replay_bench(filled.folder, filled.longer_plan(), text),
                  {"notes.sqlite", "not a database"});
}

}  // namespace
}  // namespace stillpoint
