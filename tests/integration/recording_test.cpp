// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint run --mcap`: recordings that are read back, interrupted and refused. Other readers:
// tests/browser/mcap.sh.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A run of the rendered sequence into `folder`/run that records `folder`/run.mcap.
ProgramResult record(const fs::path& folder, const std::vector<std::string>& more = {},
                     const ProgramOptions& options = {}) {
  std::vector<std::string> arguments = {"--verbose",
                                        "run",
                                        rendered_sequence().string(),
                                        "--out",
                                        (folder / "run").string(),
                                        "--mcap",
                                        (folder / "run.mcap").string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments, options);
}

/// `eval --json` of two trajectories.
nlohmann::json evaluation_of(const std::string& truth, const std::string& estimate) {
  const ProgramResult result = run_program({"eval", truth, estimate, "--json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return nlohmann::json::parse(result.out);
}

TEST(Recording, EvalReadsTheTrajectoryAndTheTruthOfTheRunBack) {
  const TemporaryFolder folder;
  ASSERT_EQ(record(folder.path(), {"--mcap-images", "--max-frames", "60"}).exit_code, 0);
  const std::string recording = (folder.path() / "run.mcap").string();
  const std::string trajectory = (folder.path() / "run" / "trajectory.tum").string();
  const std::string truth = (rendered_sequence() / "groundtruth.txt").string();
  const nlohmann::json expected = evaluation_of(truth, trajectory);
  const nlohmann::json recorded = evaluation_of(recording + ":/truth", recording + ":/estimate");
  EXPECT_EQ(recorded["evaluations"][0]["pairs"], expected["evaluations"][0]["pairs"]) << recorded.dump(1);
  // Text files have 9 decimals, recordings all digits.
  EXPECT_NEAR(recorded["evaluations"][0]["ate_rmse_m"].get<double>(),
              expected["evaluations"][0]["ate_rmse_m"].get<double>(), 1e-8);
}

TEST(Recording, AnInterruptedRunLeavesAReadableFile) {
  const TemporaryFolder folder;
  ProgramOptions options;
  options.interrupt_after = "frame 40:";
  EXPECT_EQ(record(folder.path(), {}, options).exit_code, 130);
  const ProgramResult poses = run_program({"eval", (folder.path() / "run" / "trajectory.tum").string(),
                                           (folder.path() / "run.mcap").string() + ":/estimate", "--json"});
  EXPECT_EQ(poses.exit_code, 0) << poses.err;
  EXPECT_FALSE(fs::exists(folder.path() / "run.mcap.part"));
}

TEST(Recording, AnExistingFileIsNotOverwritten) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "run.mcap") << "mine";
  const ProgramResult result = record(folder.path());
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("run.mcap"), std::string::npos) << result.err;
  EXPECT_EQ(bytes_of(folder.path() / "run.mcap"), "mine");
  EXPECT_FALSE(fs::exists(folder.path() / "run"));
}

TEST(Recording, SeveralRunsAndImagesWithoutAFileAreRefused) {
  const TemporaryFolder folder;
  const ProgramResult several = record(folder.path(), {"--variant", "vo", "--variant", "stillpoint"});
  EXPECT_EQ(several.exit_code, 2);
  EXPECT_NE(several.err.find("single run"), std::string::npos) << several.err;
  const ProgramResult images = run_program({"run", rendered_sequence().string(), "--mcap-images"});
  EXPECT_EQ(images.exit_code, 2);
  EXPECT_NE(images.err.find("--mcap FILE"), std::string::npos) << images.err;
}

TEST(Recording, AFullDiskIsReportedAfterTheResultAndLeavesNoFile) {
  const TemporaryFolder folder;
  ProgramOptions options;
  options.file_limit_bytes = 300'000;
  const ProgramResult result = record(folder.path(), {"--mcap-images", "--max-frames", "30"}, options);
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_NE(result.err.find("--mcap"), std::string::npos) << result.err;
  EXPECT_TRUE(fs::exists(folder.path() / "run" / "result.json"));
  EXPECT_FALSE(fs::exists(folder.path() / "run.mcap"));
  EXPECT_FALSE(fs::exists(folder.path() / "run.mcap.part"));
}

}  // namespace
}  // namespace stillpoint
