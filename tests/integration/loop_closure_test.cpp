// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint run --variant loop_closure`: a sequence that returns to its places.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

std::string loop_text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Plays the sequence forwards, backwards and forwards again, without its IMU.
ProgramResult run_with(const fs::path& out, const std::string& variant, const std::string& mode) {
  return run_program({"run", rendered_sequence().string(), "--out", out.string(), "--passes", "3",
                      "--variant", variant, "--mode", mode, "--set", "loop.min_gap_s=2", "--set",
                      "loop.min_translation_m=0.05", "--set", "pipeline.feedback_lag=1"});
}

TEST(LoopClosureCommand, FindsLoopsAndDoesNotChangeTheOdometry) {
  const TemporaryFolder out;
  const ProgramResult with = run_with(out.path() / "with", "vo+ablations/loop_closure", "sequential");
  ASSERT_EQ(with.exit_code, 0) << with.err;
  ASSERT_EQ(run_with(out.path() / "without", "vo", "sequential").exit_code, 0);
  EXPECT_EQ(loop_text_of(out.path() / "with" / "trajectory.tum"),
            loop_text_of(out.path() / "without" / "trajectory.tum"));
  EXPECT_FALSE(fs::exists(out.path() / "without" / "trajectory_loop.tum"));
  const nlohmann::json result = nlohmann::json::parse(loop_text_of(out.path() / "with" / "result.json"));
  EXPECT_GE(result["loops"], 3);
  EXPECT_LE(result["ate_optimized_m"], 1.02 * result["ate_rmse_m"].get<double>() + 0.001);
  const std::string keyframes = loop_text_of(out.path() / "with" / "keyframes.csv");
  EXPECT_EQ(std::ranges::count(keyframes, '\n'), 1 + result["loop_keyframes"].get<int>());
  EXPECT_LE(result["ate_loop_m"], 1.02 * result["ate_rmse_m"].get<double>() + 0.001);
}

TEST(LoopClosureCommand, PipelinedAndSequentialModeWriteEqualFiles) {
  const TemporaryFolder out;
  for (const char* mode : {"sequential", "pipelined"})
    ASSERT_EQ(run_with(out.path() / mode, "vo+ablations/loop_closure", mode).exit_code, 0);
  for (const char* file :
       {"trajectory.tum", "trajectory_loop.tum", "trajectory_optimized.tum", "loops.csv"}) {
    EXPECT_EQ(loop_text_of(out.path() / "sequential" / file), loop_text_of(out.path() / "pipelined" / file))
        << file;
  }
}

TEST(LoopClosureCommand, ALaterRunIsLocatedInASavedMap) {
  const TemporaryFolder out;
  const std::string map = (out.path() / "room.map").string();
  const auto run_map = [&](const std::string& folder, const std::string& option) {
    return run_program({"run", rendered_sequence().string(), "--out", (out.path() / folder).string(),
                        "--variant", "vo+ablations/loop_closure", option, map, "--passes", "3", "--set",
                        "loop.min_gap_s=2", "--set", "loop.min_translation_m=0.05", "--set",
                        "loop.lag_frames=5"});
  };
  const ProgramResult saved = run_map("first", "--save-map");
  ASSERT_EQ(saved.exit_code, 0) << saved.err;
  const ProgramResult located = run_map("second", "--map");
  ASSERT_EQ(located.exit_code, 0) << located.err;
  const nlohmann::json result = nlohmann::json::parse(loop_text_of(out.path() / "second" / "result.json"));
  ASSERT_TRUE(result["relocalization_s"].is_number());
  EXPECT_LT(result["ate_loop_m"], 1.02 * result["ate_rmse_m"].get<double>() + 0.005);
  // Located by current frames: before a keyframe has left the window.
  EXPECT_LE(result["relocalization_s"], 1.0);
  const nlohmann::json manifest =
      nlohmann::json::parse(loop_text_of(out.path() / "second" / "manifest.json"));
  EXPECT_EQ(manifest["map"]["checksum"].get<std::string>().size(), 16U);
  EXPECT_EQ(run_map("third", "--save-map").exit_code, 2);  // the file exists
  std::ofstream(map, std::ios::app) << "more";
  const ProgramResult refused = run_map("fourth", "--map");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("is damaged"), std::string::npos) << refused.err;
}

TEST(LoopClosureCommand, ALocatedRunExtendsTheMapIntoANewFile) {
  const TemporaryFolder out;
  const fs::path first = out.path() / "first.map", both = out.path() / "both.map";
  const auto run_map = [&](const std::string& folder, const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {
        "run",       rendered_sequence().string(), "--out",    (out.path() / folder).string(),
        "--variant", "vo+ablations/loop_closure",  "--passes", "3",
        "--set",     "loop.min_translation_m=0.05"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_program(arguments);
  };
  ASSERT_EQ(run_map("first", {"--save-map", first.string()}).exit_code, 0);
  const ProgramResult extended = run_map("second", {"--map", first.string(), "--save-map", both.string()});
  ASSERT_EQ(extended.exit_code, 0) << extended.err;
  EXPECT_GT(fs::file_size(both), fs::file_size(first));
  const ProgramResult unlocated =
      run_map("third", {"--map", first.string(), "--save-map", (out.path() / "none.map").string(), "--set",
                        "loop.min_inliers=10000"});
  EXPECT_EQ(unlocated.exit_code, 2);
  EXPECT_NE(unlocated.err.find("was not located in the map"), std::string::npos) << unlocated.err;
  EXPECT_FALSE(fs::exists(out.path() / "none.map"));
}

TEST(LoopClosureCommand, MapsRequireLoopClosure) {
  const TemporaryFolder out;
  const ProgramResult result =
      run_program({"run", rendered_sequence().string(), "--out", (out.path() / "run").string(), "--variant",
                   "vo", "--save-map", (out.path() / "a.map").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("requires loop closure"), std::string::npos) << result.err;
  const ProgramResult adjusted = run_program(
      {"run", rendered_sequence().string(), "--out", (out.path() / "run").string(), "--final-ba"});
  EXPECT_EQ(adjusted.exit_code, 2);
  EXPECT_NE(adjusted.err.find("--final-ba: requires loop closure"), std::string::npos) << adjusted.err;
}

TEST(LoopClosureCommand, FourDegreesOfFreedomRequireAnImu) {
  const TemporaryFolder out;
  const ProgramResult result = run_with(out.path(), "vo+ablations/loop_4dof", "sequential");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("loop.dof"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace stillpoint
