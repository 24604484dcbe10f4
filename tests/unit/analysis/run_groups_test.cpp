// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/run_groups.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "bench/store/store_writer.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

/// A store that is filled run by run.
class FilledStore {
 public:
  /// @param iterations config value; the config also has the seed of the run
  void add(const RunIdentity& identity, const std::string& cpu = "A", int iterations = 4) {
    StoreWriter writer(file_);
    static_cast<void>(writer.acquire(identity));
    const std::string manifest = fmt::format(
        "{{\"config\": {{\"resolved\": {{\"iterations\": {}, \"seed\": {}}}}}, "
        "\"host\": {{\"cpu\": \"{}\", \"logical_cpus\": 2}}}}",
        iterations, identity.seed, cpu);
    writer.finish(identity, {.metrics = {{"ate_rmse_m", "", "m", 0.1}}, .manifest = manifest});
    keys_.push_back(run_key(identity));
  }

  /// Stores all runs so far as a plan.
  void record_plan(const std::string& name) {
    StoreWriter(file_).record_plan({.name = name, .title = "", .text = "", .run_keys = keys_});
  }

  [[nodiscard]] Store store() const { return Store(file_); }
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

  [[nodiscard]] RunSelection select(const std::string& build = "") const {
    const Store opened = store();
    return select_runs(opened, opened.runs(), build);
  }

 private:
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "store.sqlite";
  std::vector<std::string> keys_;
};

RunIdentity identity_of(const std::string& build, std::int64_t seed = 1, const std::string& hash = "") {
  return {.variant = "vo",
          .sequence = "a",
          .config_hash = hash.empty() ? "hash" + std::to_string(seed) : hash,
          .build = build,
          .seed = seed};
}

TEST(RunGroups, TheNewestBuildIsThatOfTheLatestCommitThenOfTheLatestStart) {
  const auto run = [](const char* build, const char* committed, const char* started, std::int64_t id) {
    return StoredRun{.id = id, .identity = identity_of(build), .started = started, .committed = committed};
  };
  // The older build was measured later, and merged into the store last.
  EXPECT_EQ(newest_build(std::vector{run("new", "2026-02-01", "2026-02-02", 1),
                                     run("old", "2026-01-01", "2026-03-01", 2)}),
            "new");
  EXPECT_EQ(newest_build(std::vector{run("new", "", "2026-02-02", 1), run("old", "", "2026-02-01", 2)}),
            "new");
  EXPECT_EQ(newest_build(std::vector{run("old", "", "2026-02-02", 1), run("new", "", "2026-02-02", 2)}),
            "new");
}

TEST(RunGroups, HaveTheNewestBuildUnlessAnotherOneIsNamed) {
  FilledStore filled;
  filled.add(identity_of("build-a", 1));
  filled.add(identity_of("build-a", 2));
  filled.add(identity_of("build-b", 1));
  const RunSelection newest = filled.select();
  ASSERT_EQ(newest.groups.size(), 1u);
  EXPECT_EQ(newest.groups[0].build, "build-b");
  EXPECT_EQ(newest.groups[0].machine, "A, 2 processors");
  EXPECT_EQ(newest.groups[0].mode, "sequential, accuracy");
  EXPECT_EQ(newest.groups[0].runs.size(), 1u);
  ASSERT_EQ(newest.left_out.size(), 1u);
  EXPECT_NE(newest.left_out[0].find("build-a (2 runs)"), std::string::npos) << newest.left_out[0];
  EXPECT_EQ(filled.select("build-a").groups[0].runs.size(), 2u);
}

TEST(RunGroups, OfAllBuildsAreSeparate) {
  FilledStore filled;
  filled.add(identity_of("build-a"));
  filled.add(identity_of("build-b"));
  const RunSelection all = filled.select("all");
  ASSERT_EQ(all.groups.size(), 2u);
  EXPECT_TRUE(all.left_out.empty());
}

TEST(RunGroups, OfOneBuildAreSeparateByMachineModeAndKind) {
  FilledStore filled;
  RunIdentity realtime = identity_of("b", 1);
  realtime.mode = "realtime";
  RunIdentity timing = identity_of("b", 1);
  timing.kind = "timing";
  timing.cores = "0,1";
  filled.add(identity_of("b", 1));
  filled.add(identity_of("b", 2), "B");
  filled.add(realtime);
  filled.add(timing);
  const RunSelection selection = filled.select();
  ASSERT_EQ(selection.groups.size(), 4u);
  EXPECT_EQ(selection.groups[1].machine, "B, 2 processors");
  EXPECT_EQ(selection.groups[2].mode, "realtime, accuracy");
  EXPECT_EQ(selection.groups[3].mode, "sequential, timing, cores 0,1");
}

TEST(RunGroups, KeepTheNewestConfigOfAVariantWithAllItsSeeds) {
  FilledStore filled;
  filled.add(identity_of("b", 1, "old1"), "A", 4);
  filled.add(identity_of("b", 1, "new1"), "A", 8);
  filled.add(identity_of("b", 2, "new2"), "A", 8);
  const RunSelection selection = filled.select();
  ASSERT_EQ(selection.groups.size(), 1u);
  ASSERT_EQ(selection.groups[0].runs.size(), 2u);
  EXPECT_EQ(selection.groups[0].runs[0].identity.config_hash, "new1");
  ASSERT_EQ(selection.left_out.size(), 1u);
  EXPECT_NE(selection.left_out[0].find("vo (1 run)"), std::string::npos) << selection.left_out[0];
}

TEST(RunGroups, KeepTheNewestDataOfASequence) {
  FilledStore filled;
  RunIdentity first = identity_of("b", 1);
  first.sequence_id = "8 s";
  RunIdentity second = first;
  second.sequence_id = "20 s";
  filled.add(first);
  filled.add(second);
  const RunSelection selection = filled.select();
  ASSERT_EQ(selection.groups.front().runs.size(), 1u);
  EXPECT_EQ(selection.groups.front().runs.front().identity.sequence_id, "20 s");
  ASSERT_EQ(selection.left_out.size(), 1u);
  EXPECT_NE(selection.left_out[0].find("older data"), std::string::npos) << selection.left_out[0];
}

TEST(RunGroups, ABuildWithChangesIsNotNamedByItsCommit) {
  FilledStore filled;
  filled.add(identity_of("abc123+ff00"));
  expect_input_error([&] { static_cast<void>(filled.select("abc123")); }, {"abc123+ff00", "--build"});
  EXPECT_EQ(filled.select("abc123+").groups.size(), 1u);
  filled.add(identity_of("abc123"));
  EXPECT_EQ(filled.select("abc123").groups[0].build, "abc123");
}

TEST(RunGroups, KeepFailedRunsWithoutAManifestWithTheirMachineAndConfig) {
  FilledStore filled;
  filled.add(identity_of("b", 1, "old1"), "A", 4);
  {
    StoreWriter writer(filled.store().file());
    const RunIdentity crashed = identity_of("b", 1, "new1");
    static_cast<void>(writer.acquire(crashed));
    writer.finish(crashed, {.outcome = Outcome::kCrashed});
  }
  filled.add(identity_of("b", 2, "new2"), "A", 8);
  const RunSelection selection = filled.select();
  ASSERT_EQ(selection.groups.size(), 1u);
  ASSERT_EQ(selection.groups[0].runs.size(), 2u);
  EXPECT_EQ(selection.groups[0].runs[0].outcome, Outcome::kCrashed);
}

TEST(RunGroups, OfImportedRunsWithoutABuildHaveTheirMachine) {
  FilledStore filled;
  filled.add(identity_of("", 1), "A");
  filled.add(identity_of("", 2), "B");
  const RunSelection selection = filled.select();
  ASSERT_EQ(selection.groups.size(), 2u);
  EXPECT_EQ(selection.groups[0].machine, "A, 2 processors");
  EXPECT_EQ(selection.groups[1].machine, "B, 2 processors");
}

TEST(RunGroups, KeepAFirstRunWithoutAManifestWithThoseThatFollow) {
  FilledStore filled;
  {
    StoreWriter writer(filled.file());
    const RunIdentity crashed = identity_of("b", 1);
    static_cast<void>(writer.acquire(crashed));
    writer.finish(crashed, {.outcome = Outcome::kCrashed});
  }
  filled.add(identity_of("b", 2));
  const RunSelection selection = filled.select();
  ASSERT_EQ(selection.groups.size(), 1u);
  EXPECT_EQ(selection.groups[0].machine, "A, 2 processors");
}

TEST(RunGroups, RejectUnknownAndAmbiguousBuilds) {
  FilledStore filled;
  filled.add(identity_of("build-a"));
  filled.add(identity_of("build-b"));
  expect_input_error([&] { static_cast<void>(filled.select("c")); },
                     {"--build", "\"c\"", "build-b, build-a"});
  expect_input_error([&] { static_cast<void>(filled.select("build")); }, {"--build", "several", "build-a"});
}

TEST(RunsOfPlan, IncludeTheSameEntriesOfOtherBuilds) {
  FilledStore filled;
  filled.add(identity_of("build-b", 1));
  filled.record_plan("short");
  filled.add(identity_of("build-b", 2));
  filled.add(identity_of("build-a", 1));
  filled.add(identity_of("build-a", 2));
  const std::vector<StoredRun> runs = runs_of_plan(filled.store(), "short");
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].identity.build, "build-b");
  EXPECT_EQ(runs[1].identity.build, "build-a");
  EXPECT_EQ(runs[1].identity.seed, 1);
}

}  // namespace
}  // namespace stillpoint::bench
