// SPDX-License-Identifier: BSD-3-Clause
// Help, usage errors, and small commands.
#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

class HelpOf : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(HelpOf, ShowsAnExample) {
  std::vector<std::string> arguments = GetParam();
  std::string command = "  stillpoint";
  for (const std::string& word : arguments) command += " " + word;
  arguments.push_back("--help");
  const ProgramResult result = run_program(arguments);
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("Example:\n" + command), std::string::npos) << result.out;
  EXPECT_EQ(result.err, "");
}

INSTANTIATE_TEST_SUITE_P(
    EveryCommand, HelpOf,
    testing::Values(std::vector<std::string>{"run"}, std::vector<std::string>{"eval"},
                    std::vector<std::string>{"bench"}, std::vector<std::string>{"config", "show"},
                    std::vector<std::string>{"config", "list"}, std::vector<std::string>{"config", "diff"},
                    std::vector<std::string>{"config", "reference"},
                    std::vector<std::string>{"data", "check"}, std::vector<std::string>{"data", "synth"},
                    std::vector<std::string>{"device", "info"}));

class WrongUsage : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(WrongUsage, IsOneErrorLineAndExitCodeTwo) {
  const ProgramResult result = run_program(GetParam());
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(result.err.starts_with("stillpoint: error: command line: ")) << result.err;
  EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << result.err;
  EXPECT_EQ(result.out, "");
}

INSTANTIATE_TEST_SUITE_P(CommandLine, WrongUsage,
                         testing::Values(std::vector<std::string>{}, std::vector<std::string>{"unknown"},
                                         std::vector<std::string>{"run"},
                                         std::vector<std::string>{"run", "a", "b"},
                                         std::vector<std::string>{"run", "a", "--sped", "3"},
                                         std::vector<std::string>{"run", "a", "--max-frames", "many"}));

// OpenImageIO and OpenCV's video encoders load 205 further libraries, in 0.2 s.
TEST(ProgramStart, LoadsNeitherImageNorVideoLibraries) {
  const ProgramResult result = run_program({}, {.environment = {"LD_TRACE_LOADED_OBJECTS=1"}});
  EXPECT_NE(result.out.find("libopencv_core"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("libOpenImageIO"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("libavcodec"), std::string::npos) << result.out;
}

TEST(ConfigCommand, PrintsTheResolvedValuesOfAVariant) {
  const ProgramResult result =
      run_program({"config", "show", "--config", "dynamic_vins", "--variant", "vo", "--set", "seed=5"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("\nimu.enabled = false\n"), std::string::npos);
  EXPECT_NE(result.out.find("\nseed = 5\n"), std::string::npos);
}

TEST(ConfigCommand, WarnsOfASettingWithoutEffect) {
  const ProgramResult result = run_program({"config", "show", "--set", "loop.min_gap_s=3"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("\nloop.min_gap_s = 3.0\n"), std::string::npos);
  EXPECT_NE(result.err.find("\"loop.min_gap_s\" has no effect; it requires loop.enabled = true"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(run_program({"config", "show", "--variant", "vo"}).err, "");
}

TEST(ConfigCommand, PrintsTheKeysThatDifferBetweenTwoConfigs) {
  const ProgramResult result = run_program({"config", "diff", "stillpoint", "stillpoint+wo_mcc+datasheet"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out,
            "imu.noise_scale = 1.0 -> 2.0\n"
            "dynamic.moving_consistency = true -> false\n");
  EXPECT_EQ(result.err, "");
  EXPECT_NE(run_program({"config", "diff", "dynamic_vins", "stillpoint"})
                .out.find("backend.keyframe_max_interval_s = 10.0 -> 0.5 s\n"),
            std::string::npos);
  EXPECT_EQ(run_program({"config", "diff", "vo", "vo"}).out, "");
}

TEST(ConfigCommand, ListsOverlays) {
  EXPECT_NE(run_program({"config", "list"}).out.find("ablations/wo_circular_mask\n"), std::string::npos);
}

TEST(EvalCommand, ScoresATrajectoryAgainstItself) {
  const TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 30; ++i) text += std::to_string(0.1 * i) + " " + std::to_string(i) + " 0 0 0 0 0 1\n";
  const std::string file = folder.write("a.tum", text).string();
  const ProgramResult result = run_program({"eval", file, file, "--json"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("\"ate_pairs\": 30"), std::string::npos) << result.out;
}

TEST(EvalCommand, ReportsTheLineOfAMalformedFile) {
  const TemporaryFolder folder;
  const std::string file = folder.write("a.tum", "1 0 0 0 0 0 0 1\n2 0 0\n").string();
  const ProgramResult result = run_program({"eval", file, file});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(result.err.starts_with("stillpoint: error: " + file + ":2: ")) << result.err;
}

TEST(SynthCommand, ExplainsWhatDoesNotFitToAMeshOrARig) {
  const auto expect = [](std::vector<std::string> options, const std::vector<std::string>& parts) {
    options.insert(options.begin(), {"data", "synth"});
    const ProgramResult result = run_program(options);
    EXPECT_EQ(result.exit_code, 2);
    for (const std::string& part : parts) EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  };
  expect({"--mesh", "scan.ply"}, {"preset \"mesh\"", "--trajectory"});
  expect({"office_laps", "--mesh", "scan.ply"}, {"office_laps", "--mesh"});
  expect({"--mesh", "none.ply", "--trajectory", "none.txt"}, {"none.txt"});
  expect({"market", "--rig", "none.toml"}, {"none.toml", "no such rig file"});
  expect({"market", "--rig", "none.toml", "--width", "320"}, {"--rig", "--width"});
}

}  // namespace
}  // namespace stillpoint
