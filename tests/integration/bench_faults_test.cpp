// SPDX-License-Identifier: BSD-3-Clause
// Benchmarks over plans, data and stores that are not as they should be: one clear error, and no stored row
// lost.
#include <gtest/gtest.h>

#include <fstream>

#include <unistd.h>

#include "bench/store/database.h"
#include "bench/store/schema.h"
#include "bench/store/store.h"
#include "tests/support/refusal.h"
#include "tests/support/replay_bench.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// A folder with a plan of two runs, and a store that has them.
struct FilledStore {
  TemporaryFolder folder;
  fs::path plan = write_replay_plan(folder, 1, "");
  fs::path store = folder.path() / "store.sqlite";
  FilledStore() { EXPECT_EQ(replay_bench(folder, plan, store).exit_code, 0); }

  /// As the plan, with more runs to make.
  [[nodiscard]] fs::path longer_plan(int repetitions = 3) const {
    return write_replay_plan(folder, repetitions, "");
  }
};

TEST(BenchFaults, AMalformedPlanIsRefusedBeforeAnyRun) {
  const TemporaryFolder folder;
  const fs::path store = folder.path() / "store.sqlite";
  const fs::path broken = folder.write("broken.toml", "title = \"x\"\nsequences = [\n");
  expect_refused(replay_bench(folder, broken, store), {"broken.toml:"});
  const fs::path unknown = folder.write("unknown.toml", "repetition = 3\n");
  expect_refused(replay_bench(folder, unknown, store),
                 {"unknown.toml:1: unknown key \"repetition\"; did you mean \"repetitions\"?"});
  const fs::path wrong = folder.write("wrong.toml", "repetitions = \"many\"\n");
  expect_refused(replay_bench(folder, wrong, store), {"wrong.toml:1", "repetitions"});
  EXPECT_FALSE(fs::exists(store));
}

TEST(BenchFaults, AnUnknownSequenceIsRefusedBeforeAnyRun) {
  const TemporaryFolder folder;
  const fs::path store = folder.path() / "store.sqlite";
  const fs::path recorded = folder.write("recorded.toml", "[recorded]\nsequences = [\"nowhere\"]\n");
  expect_refused(replay_bench(folder, recorded, store), {"nowhere"});
  const fs::path rendered = folder.write("rendered.toml", "[rendered]\nsequences = [\"walking_xyy\"]\n");
  expect_refused(replay_bench(folder, rendered, store), {"walking_xyy"});
  EXPECT_FALSE(fs::exists(store));
}

TEST(BenchFaults, DataThatHaveVanishedAreNamedAndCostNoStoredRow) {
  const FilledStore filled;
  const fs::path plan = filled.folder.write(
      "vanished.toml",
      "systems = [\"" + (filled.folder.path() / "replay.toml").string() +
          "\"]\nrepetitions = 2\n[recorded]\nsequences = [\"freiburg1_a\", \"freiburg1_b\"]\n");
  fs::remove_all(filled.folder.path() / "freiburg1_b");
  expect_refused(replay_bench(filled.folder, plan, filled.store), {"freiburg1_b"});
  EXPECT_EQ(Store(filled.store).runs().size(), 2u);
}

TEST(BenchFaults, DataThatVanishDuringABenchmarkCostOnlyTheirRuns) {
  const TemporaryFolder folder;
  const fs::path plan = write_replay_plan(folder, 1, "");
  // The first system takes the other sequence away.
  folder.write("replay.toml",
               "name = \"thief\"\nversion = \"1\"\nlayout = \"as_is\"\ncommand = [\"/bin/sh\", \"-c\", "
               "\"rm -rf " +
                   (folder.path() / "freiburg1_b").string() + "; exit 1\"]\n");
  const fs::path store = folder.path() / "store.sqlite";
  const ProgramResult result = run_program(
      {"bench", plan.string(), "--store", store.string(), "--out", (folder.path() / "out").string()},
      {.environment = {"STILLPOINT_DATA=" + folder.path().string(),
                       "STILLPOINT_REGISTRY=" + (folder.path() / "none.json").string()}});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  const std::vector<StoredRun> runs = Store(store).runs();
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[1].outcome, Outcome::kBadData);
  EXPECT_NE(runs[1].detail.find("freiburg1_b"), std::string::npos) << runs[1].detail;
}

TEST(BenchFaults, AFullDiskLosesNoStoredRowAndTheNextCallGoesOn) {
  const FilledStore filled;
  const fs::path plan = filled.longer_plan(60);
  ProgramOptions full;
  full.file_limit_bytes = 120'000;  // the store and its log grow beyond it before all is done
  const ProgramResult result = replay_bench(filled.folder, plan, filled.store, full);
  expect_refused(result, {"free space"});
  const std::size_t kept = Store(filled.store).runs().size();
  EXPECT_GE(kept, 2u);
  EXPECT_LT(kept, 120u);
  EXPECT_EQ(replay_bench(filled.folder, plan, filled.store).exit_code, 0);  // there is space again
  EXPECT_EQ(Store(filled.store).runs().size(), 120u);
}

TEST(BenchFaults, AStoreThatMayOnlyBeReadIsListedAndNotFilled) {
  const FilledStore filled;
  const fs::path plan = filled.longer_plan();
  const ProgramOptions reader{.may_only_read = true};
  fs::permissions(filled.store, fs::perms(0444));
  fs::permissions(filled.folder.path(), fs::perms(0555));
  const ProgramResult list = run_program({"store", "list", "--store", filled.store.string()}, reader);
  const TemporaryFolder out;
  fs::permissions(out.path(), fs::perms::all);
  const ProgramResult result = run_program(
      {"bench", plan.string(), "--store", filled.store.string(), "--out", (out.path() / "out").string()},
      {.environment = {"STILLPOINT_DATA=" + filled.folder.path().string(),
                       "STILLPOINT_REGISTRY=" + (filled.folder.path() / "none.json").string()},
       .may_only_read = true});
  fs::permissions(filled.folder.path(), fs::perms::owner_all);
  if (list.exit_code == 127) GTEST_SKIP() << "another user cannot start the program where it was built";
  EXPECT_EQ(list.exit_code, 0) << list.err;
  expect_refused(result, {"store.sqlite", "Permission denied", "must be writable"});
  EXPECT_EQ(Store(filled.store).runs().size(), 2u);
}

TEST(BenchFaults, AStoreOfANewerVersionIsRefusedByEveryCommand) {
  const FilledStore filled;
  Database(filled.store, DatabaseAccess::kWrite)
      .execute("PRAGMA user_version = " + std::to_string(schema_version() + 1));
  const std::string store = filled.store.string();
  expect_refused(replay_bench(filled.folder, filled.longer_plan(), filled.store), {"newer version"});
  expect_refused(run_program({"store", "list", "--store", store}), {"newer version"});
  expect_refused(run_program({"stats", "summary", "--store", store}), {"newer version"});
  expect_refused(run_program({"compare", store, store}), {"newer version"});
  Database(filled.store, DatabaseAccess::kWrite)
      .execute("PRAGMA user_version = " + std::to_string(schema_version()));
  EXPECT_EQ(Store(filled.store).runs().size(), 2u);  // nothing was changed
}

TEST(BenchFaults, ADamagedStoreIsRefusedAndNotWrittenTo) {
  const FilledStore filled;
  {
    std::fstream stream(filled.store, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(4096);  // the second page, a table's
    stream << std::string(4096, '\xff');
  }
  const auto size = fs::file_size(filled.store);
  expect_refused(replay_bench(filled.folder, filled.longer_plan(), filled.store),
                 {"store.sqlite", "damaged"});
  EXPECT_EQ(fs::file_size(filled.store), size);
  const fs::path text = filled.folder.write("notes.sqlite", std::string(5000, 'n'));
  expect_refused(replay_bench(filled.folder, filled.longer_plan(), text), {"notes.sqlite", "not a database"});
}

}  // namespace
}  // namespace stillpoint
