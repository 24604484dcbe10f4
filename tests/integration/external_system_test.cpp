// SPDX-License-Identifier: BSD-3-Clause
// External programs as benchmark systems: exported sequences, and import of their trajectories and times.
#include <gtest/gtest.h>

#include "bench/store/store.h"
#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReplay = STILLPOINT_BINARY_DIR "/tests/replay_program";

/// Benchmarks the system of a file in the folder on the rendered sequence.
ProgramResult bench_system(const TemporaryFolder& folder, const std::string& file) {
  const fs::path plan = folder.write("plan.toml", "systems = [\"" + (folder.path() / file).string() +
                                                      "\"]\nprotocols = [\"strict:se3\"]\n" +
                                                      "[recorded]\nsequences = [\"office\"]\n");
  ProgramOptions options;
  options.environment = {"STILLPOINT_DATA=" + rendered_sequence().parent_path().string(),
                         "STILLPOINT_REGISTRY=" + (folder.path() / "none.json").string(),
                         "STILLPOINT_CACHE=" + (folder.path() / "cache").string()};
  return run_program({"bench", plan.string(), "--store", (folder.path() / "store.sqlite").string(), "--out",
                      (folder.path() / "out").string()},
                     options);
}

/// Benchmarks the replay program. @param keys additional lines of its system file
ProgramResult run_bench(const TemporaryFolder& folder, const std::string& keys,
                        const std::string& flags = "") {
  folder.write("replay.toml", "name = \"replay\"\n" + keys + "command = [\"" + kReplay + "\", " + flags +
                                  "\"run\", \"{sequence}\", \"--out\", \"{out}\"]\n");
  return bench_system(folder, "replay.toml");
}

bench::StoredRun run_of(const TemporaryFolder& folder) {
  return bench::Store(folder.path() / "store.sqlite").runs().front();
}

TEST(ExternalSystem, ReadsAnExportedSequenceAndIsScored) {
  const TemporaryFolder folder;
  const ProgramResult result =
      run_bench(folder, "layout = \"tum\"\ntimings = \"result.json\"\n", "\"--error\", \"0.01\", ");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const bench::StoredRun run = run_of(folder);
  EXPECT_EQ(run.identity.system, "replay");
  EXPECT_EQ(run.outcome, bench::Outcome::kOk) << run.detail;
  // A sine of amplitude 0.01 m has an RMS of 0.01 / sqrt(2) = 0.0071 m; the alignment reduces it slightly.
  EXPECT_NEAR(*bench::metric_value(run, "ate_rmse_m"), 0.0071, 0.0003);
  EXPECT_NEAR(*bench::metric_value(run, "strict:se3/ate_rmse_m"), 0.0071, 0.0003);
  EXPECT_GT(*bench::metric_value(run, "process_wall_s"), 0.0);
  EXPECT_GT(*bench::metric_value(run, "peak_memory_mb"), 1.0);
  EXPECT_EQ(run.costs.size(), 2u);
  EXPECT_TRUE(fs::exists(folder.path() / "cache" / "exports"));
  EXPECT_NE(result.out.find("| office   | replay"), std::string::npos) << result.out;
}

TEST(ExternalSystem, WithoutTrajectoryIsLost) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_bench(folder, "layout = \"tum\"\ntrajectory = \"elsewhere.txt\"\n").exit_code, 1);
  EXPECT_EQ(run_of(folder).outcome, bench::Outcome::kLost);
  EXPECT_EQ(run_of(folder).detail, "wrote no elsewhere.txt");
}

TEST(ExternalSystem, WithOnePoseIsLost) {
  const TemporaryFolder folder;
  const std::string script =
      folder.write("one.sh", "#!/bin/sh\necho '0.1 0 0 0 0 0 0 1' >\"$1/trajectory.tum\"\n").string();
  folder.write("one.toml",
               "name = \"one\"\nlayout = \"tum\"\ncommand = [\"sh\", \"" + script + "\", \"{out}\"]\n");
  const ProgramResult result = bench_system(folder, "one.toml");
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_EQ(run_of(folder).outcome, bench::Outcome::kLost);
  EXPECT_EQ(run_of(folder).detail, "trajectory.tum has only one pose, which tells no error");
  EXPECT_NE(result.out.find("| lost "), std::string::npos) << result.out;
}

TEST(ExternalSystem, IsRejectedWithoutACommand) {
  const TemporaryFolder folder;
  const auto system = folder.write("s.toml", "name = \"s\"\n");
  const auto plan = folder.write(
      "plan.toml", "systems = [\"" + system.string() + "\"]\n[rendered]\nsequences = [\"market\"]\n");
  const ProgramResult result = run_program({"plan", "show", plan.string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("s.toml: has no command"), std::string::npos) << result.err;
}

TEST(ExternalSystem, BenchRejectsFilesThatAreNotStores) {
  const TemporaryFolder folder;
  const auto plan = folder.write("plan.toml", "variants = [\"vo\"]\n[rendered]\nsequences = [\"market\"]\n");
  const auto notes = folder.write("notes.txt", std::string(3000, 'n'));
  const ProgramResult result = run_program(
      {"bench", plan.string(), "--store", notes.string(), "--out", (folder.path() / "out").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(result.err.starts_with("stillpoint: error: " + notes.string())) << result.err;
  EXPECT_EQ(fs::file_size(notes), 3000u);
}

TEST(RegisteredSequence, IsRejectedAfterItsFilesHaveChanged) {
  const TemporaryFolder folder;
  const fs::path copy = copy_of_rendered_sequence(folder);
  const auto plan = folder.write("plan.toml", "variants = [\"vo\"]\n[recorded]\nsequences = [\"named\"]\n");
  ProgramOptions options;
  options.environment = {"STILLPOINT_REGISTRY=" + (folder.path() / "sequences.json").string()};
  EXPECT_EQ(run_program({"data", "add", "named", copy.string()}, options).exit_code, 0);
  const std::string list = run_program({"data", "list"}, options).out;
  EXPECT_TRUE(list.starts_with("named ")) << list;
  EXPECT_EQ(run_program({"plan", "show", plan.string()}, options).exit_code, 0);
  std::ofstream(copy / "groundtruth.txt", std::ios::app) << "# one more line\n";
  const ProgramResult changed = run_program({"plan", "show", plan.string()}, options);
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_NE(changed.err.find("as registered"), std::string::npos) << changed.err;
}

}  // namespace
}  // namespace stillpoint
