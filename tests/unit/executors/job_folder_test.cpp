// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/distribution.h"

#include <gtest/gtest.h>

#include <fstream>

#include "bench/store/store.h"
#include "bench/systems/slam_system.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/sequences/fake_sequence.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

BenchPlan plan_in(const TemporaryFolder& folder) {
  return load_plan(folder.write("p.toml",
                                "variants = [\"stillpoint\", \"vo\"]\n[rendered]\nsequences = "
                                "[\"walking_static\"]\n"));
}

std::vector<std::string> keys_of(const BenchPlan& plan) { return expand_plan(plan, build_name(), {}).keys; }

void store_run(const fs::path& store, const RunIdentity& identity, double error) {
  StoreWriter writer(store);
  static_cast<void>(writer.acquire(identity));
  writer.finish(identity, {.metrics = {{"ate_rmse_m", "p", "m", error}}});
}

TEST(JobFolder, ATaskHasTheRunsOfItsKeys) {
  const TemporaryFolder folder;
  const BenchPlan plan = plan_in(folder);
  const std::vector<std::string> keys = keys_of(plan);
  const fs::path job = folder.path() / "job";
  write_job(job, plan, {{keys[0]}, {keys[1]}, {}}, SystemFiles::kCopied);
  write_job(job, plan, {{keys[1]}, {keys[0]}}, SystemFiles::kCopied);
  const PlanMatrix matrix = job_matrix(job, task_keys(job, 1));
  ASSERT_EQ(matrix.runs.size(), 1u);
  EXPECT_EQ(run_key(matrix.runs[0].identity), keys[1]);
  EXPECT_EQ(all_task_keys(job), (std::vector<std::string>{keys[1], keys[0]}));
  expect_input_error([&] { static_cast<void>(task_keys(job, 3)); }, {"keys-3", "does not exist"});
}

TEST(JobFolder, ARunThatThisMachineDoesNotHaveIsAnError) {
  const TemporaryFolder folder;
  const fs::path job = folder.path() / "job";
  write_job(job, plan_in(folder), {{"0123456789abcdef"}}, SystemFiles::kCopied);
  expect_input_error([&] { static_cast<void>(job_matrix(job, task_keys(job, 1))); },
                     {"has 1 run (e.g. 0123456789abcdef)"});
  std::ofstream(job / "build") << "another\n";
  expect_input_error([&] { static_cast<void>(job_matrix(job, task_keys(job, 1))); }, {"build another"});
}

// The workers of another machine have only the job folder.
TEST(JobFolder, DescriptionsTravelWithTheFilesOfTheirCommand) {
  const TemporaryFolder folder;
  folder.write("sys/tools/run.sh", "exit 0\n");
  folder.write("sys/slam.toml",
               "name = \"slam\"\ncommand = [\"sh\", \"{here}/tools/run.sh\", \"{param.n}\"]\n[param]\nn = 1\n"
               "[variant.few]\nn = 0\n");
  const std::string file = (folder.path() / "sys/slam.toml").string();
  const BenchPlan plan = load_plan(
      folder.write("p.toml", "systems = [\"" + file + "\", \"" + file +
                                 "+few\", \"orb_pnp\"]\n[rendered]\nsequences = [\"walking_static\"]\n"));
  const std::vector<std::string> keys = keys_of(plan);
  const fs::path job = folder.path() / "job";
  write_job(job, plan, {keys}, SystemFiles::kCopied);
  fs::rename(job, folder.path() / "elsewhere");
  fs::remove_all(folder.path() / "sys");
  const PlanMatrix matrix = job_matrix(folder.path() / "elsewhere", keys);
  EXPECT_EQ(matrix.keys, keys);
  ASSERT_EQ(matrix.systems.size(), 3u);
  EXPECT_EQ(matrix.systems[1].variant, "slam+few");
  EXPECT_TRUE(fs::exists(fs::path(matrix.systems[1].folder) / "tools/run.sh"));
  std::ofstream(fs::path(matrix.systems[0].folder) / "tools/run.sh") << "exit 1\n";
  expect_input_error([&] { static_cast<void>(job_matrix(folder.path() / "elsewhere", keys)); },
                     {"system files differ"});
}

// Neither the folder of the plan nor the working folder of the caller is known to a worker.
TEST(JobFolder, ConfigsTravelWithTheFilesThatTheyInherit) {
  const TemporaryFolder folder;
  folder.write("common/solver.toml", "backend.max_iterations = 3\n");
  folder.write("plans/cfg/fast.toml",
               "inherits = \"../../common/solver.toml\"\nfrontend.max_features = 90\n");
  folder.write("plans/base.toml", "inherits = \"dynamic_vins\"\nbackend.max_iterations = 5\n");
  const BenchPlan plan = load_plan(
      folder.write("plans/p.toml",
                   "base = \"base.toml\"\nvariants = [\"cfg/fast.toml+wo_mcc\", \"../common/solver.toml\"]\n"
                   "[rendered]\nsequences = [\"walking_static\"]\n"));
  const std::vector<std::string> keys = keys_of(plan);
  const fs::path job = folder.path() / "job";
  write_job(job, plan, {keys}, SystemFiles::kShared);
  EXPECT_EQ(job_matrix(job, keys).keys, keys);
  write_job(job, plan, {keys}, SystemFiles::kCopied);
  const fs::path elsewhere = folder.path() / "elsewhere";
  fs::rename(job, elsewhere);
  fs::remove_all(folder.path() / "plans");
  fs::remove_all(folder.path() / "common");
  EXPECT_EQ(job_matrix(elsewhere, keys).keys, keys);
}

TEST(JobFolder, SequencesAreFoundByThePathsOfThePlan) {
  const TemporaryFolder folder;
  fake_sequence(folder, "plans/seq");
  fake_sequence(folder, "other");
  const BenchPlan plan = load_plan(
      folder.write("plans/p.toml",
                   "variants = [\"vo\"]\nimages = 0\n[recorded]\nsequences = [\"./seq\", \"../other\"]\n"));
  const std::vector<std::string> keys = keys_of(plan);
  ASSERT_EQ(keys.size(), 2u);
  const fs::path job = folder.path() / "job";
  write_job(job, plan, {keys}, SystemFiles::kShared);
  EXPECT_EQ(job_matrix(job, keys).keys, keys);
  write_job(job, plan, {keys}, SystemFiles::kCopied);
  expect_input_error([&] { static_cast<void>(job_matrix(job, keys)); }, {"data/seq", "neither a folder"});
  fs::create_directories(job / "data");
  fs::rename(folder.path() / "plans/seq", job / "data/seq");
  fs::rename(folder.path() / "other", job / "data/other");
  EXPECT_EQ(job_matrix(job, keys).keys, keys);
}

// Copies of these would be other systems with the same key.
TEST(JobFolder, DescriptionsThatNeedMoreThanTheirFilesAreUsedWhereTheyAre) {
  const TemporaryFolder folder;
  folder.write("sys/cfg/a.yaml", "a: 1\n");
  folder.write("prog/run.sh", "exit 0\n");
  for (const std::string keys :
       {"command = [\"sh\", \"{here}/cfg\"]", "command = [\"sh\", \"--config={here}/cfg/a.yaml\"]",
        "command = [\"sh\", \"{here}/../prog/run.sh\"]", "command = [\"../prog/run.sh\"]",
        "command = [\"sh\", \"{here}/cfg/../../prog/run.sh\"]", "command = [\"sh\"]\nworking_folder = \".\"",
        "command = [\"sh\"]\nenvironment = [\"LD_LIBRARY_PATH={here}/lib\"]",
        "command = [\"sh\"]\ncalibration_template = \"../prog/run.sh\"",
        "command = [\"{binary}\"]\n[source]\ngit = \"..\"\nbinary = \"prog/run.sh\""}) {
    const fs::path file = folder.write("sys/slam.toml", "name = \"slam\"\n" + keys + "\n");
    const BenchPlan plan = load_plan(folder.write(
        "p.toml", "systems = [\"" + file.string() + "\"]\n[rendered]\nsequences = [\"walking_static\"]\n"));
    const fs::path job = folder.path() / "job";
    expect_input_error([&] { write_job(job, plan, {keys_of(plan)}, SystemFiles::kCopied); },
                       {"slam.toml: ", "cannot be copied to another machine", "absolute path"});
    write_job(job, plan, {keys_of(plan)}, SystemFiles::kShared);
    EXPECT_EQ(job_matrix(job, keys_of(plan)).systems.at(0).path, file) << keys;
  }
}

TEST(JobFolder, MergingIsIdempotentAndCompletesAnInterruptedMerge) {
  const TemporaryFolder folder;
  const fs::path job = folder.path() / "job";
  fs::create_directories(job);
  const RunIdentity first{.variant = "a"};
  const RunIdentity second{.variant = "b"};
  const fs::path store = folder.path() / "all.sqlite";
  store_run(store, first, 1.0);  // was merged before the interruption
  store_run(job / "store-1.sqlite", first, 2.0);
  store_run(job / "store-2.sqlite", second, 3.0);
  std::ofstream(job / "store-3.sqlite").close();  // its worker was killed at the start
  const MergeReport report = merge_tasks(job, store);
  EXPECT_EQ(report.added, 1u);
  EXPECT_EQ(report.present, 1u);
  ASSERT_EQ(report.contradicting.size(), 1u) << "it ended twice, with different errors";
  EXPECT_NE(report.contradicting.front().find(run_key(first)), std::string::npos);
  EXPECT_EQ(merge_tasks(job, store).added, 0u);
  const std::vector<StoredRun> runs = Store(store).runs();
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(metric_value(runs[0], "ate_rmse_m"), 1.0);
  EXPECT_EQ(std::distance(fs::directory_iterator(job), {}), 1);  // the lock
}

}  // namespace
}  // namespace stillpoint::bench
