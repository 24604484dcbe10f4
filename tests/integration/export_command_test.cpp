// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint data export`: an exported sequence gives the trajectory of the original.
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// The trajectory of a run; empty if it fails.
std::string trajectory_of(const fs::path& sequence, const fs::path& out) {
  const ProgramResult result = run_program(
      {"run", sequence.string(), "--out", out.string(), "--max-frames", "45", "--no-frame-cache"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::ifstream stream(out / "trajectory.tum");
  return {std::istreambuf_iterator<char>(stream), {}};
}

class ExportCommand : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(ExportCommand, GivesTheTrajectoryOfTheOriginal) {
  const TemporaryFolder folder;
  const fs::path exported = folder.path() / GetParam().front();
  std::vector<std::string> arguments{"data", "export", rendered_sequence().string(), "--out",
                                     exported.string()};
  arguments.insert(arguments.end(), GetParam().begin() + 1, GetParam().end());
  const ProgramResult result = run_program(arguments);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string expected = trajectory_of(rendered_sequence(), folder.path() / "expected");
  EXPECT_GT(expected.size(), 1000U);
  EXPECT_EQ(trajectory_of(exported, folder.path() / "run"), expected);
}

INSTANTIATE_TEST_SUITE_P(Layouts, ExportCommand,
                         testing::Values(std::vector<std::string>{"a.bag", "--compression", "lz4"},
                                         std::vector<std::string>{"a.mcap", "--compression", "zstd"},
                                         std::vector<std::string>{"rosbag2"},
                                         std::vector<std::string>{"tum", "--layout", "tum"}));

}  // namespace
}  // namespace stillpoint
