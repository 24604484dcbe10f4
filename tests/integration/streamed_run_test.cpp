// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint run PRESET` from an empty cache: frames are rendered while they are tracked.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// Runs of a preset with a cache of their own. Its images are small, to render them faster.
class StreamedRun : public ::testing::Test {
 protected:
  static constexpr const char* kPreset = "office_laps_short";

  [[nodiscard]] ProgramResult run(const std::string& name, std::vector<std::string> arguments,
                                  const std::string& interrupt_after = "") const {
    arguments.insert(arguments.end(), {"--out", (folder_.path() / name).string()});
    ProgramOptions options{.environment = {"STILLPOINT_CACHE=" + (folder_.path() / "cache").string()}};
    options.interrupt_after = interrupt_after;
    return run_program(arguments, options);
  }
  /// Poses and states, which a run gives bit by bit.
  [[nodiscard]] std::string result_of(const std::string& name) const {
    std::string text;
    for (const char* file : {"trajectory.tum", "status.csv", "counters.csv"}) {
      std::ifstream in(folder_.path() / name / file);
      text.append(std::istreambuf_iterator<char>(in), {});
    }
    return text;
  }
  /// Number of images of the preset in the cache.
  [[nodiscard]] std::ptrdiff_t rendered_images() const {
    const fs::recursive_directory_iterator files(folder_.path() / "cache" / "synthetic");
    return std::count_if(begin(files), end(files),
                         [](const auto& file) { return file.path().parent_path().filename() == "color"; });
  }

  TemporaryFolder folder_;
};

TEST_F(StreamedRun, GivesTheBitsOfTheCachedAndTheCompleteSequence) {
  const ProgramResult streamed = run("streamed", {"run", kPreset, "--max-frames", "40"});
  ASSERT_EQ(streamed.exit_code, 0) << streamed.err;
  // No frame more than is played, of 1080.
  EXPECT_EQ(rendered_images(), 40);
  ASSERT_EQ(run("cached", {"run", kPreset, "--max-frames", "40"}).exit_code, 0);
  ASSERT_EQ(run("pipelined", {"run", kPreset, "--seconds", "1.33", "--mode", "pipelined"}).exit_code, 0);
  EXPECT_EQ(rendered_images(), 40);
  const std::string sequence = (folder_.path() / kPreset).string();
  ASSERT_EQ(run(kPreset, {"data", "synth", kPreset, "--seconds", "1.34"}).exit_code, 0);
  ASSERT_EQ(run("complete", {"run", sequence, "--max-frames", "40"}).exit_code, 0);
  EXPECT_GT(result_of("streamed").size(), 1000U);
  EXPECT_EQ(result_of("cached"), result_of("streamed"));
  EXPECT_EQ(result_of("pipelined"), result_of("streamed"));
  EXPECT_EQ(result_of("complete"), result_of("streamed"));
}

TEST_F(StreamedRun, ContinuesWhatAnInterruptedOneRendered) {
  const ProgramResult interrupted =
      run("interrupted", {"--verbose", "run", kPreset, "--max-frames", "30"}, "frame 5:");
  EXPECT_EQ(interrupted.exit_code, 130) << interrupted.err;
  const std::ptrdiff_t kept = rendered_images();
  EXPECT_GE(kept, 6);
  EXPECT_LT(kept, 30);
  ASSERT_EQ(run("continued", {"run", kPreset, "--max-frames", "30"}).exit_code, 0);
  EXPECT_EQ(rendered_images(), 30);
  fs::remove_all(folder_.path() / "cache");
  ASSERT_EQ(run("fresh", {"run", kPreset, "--max-frames", "30"}).exit_code, 0);
  EXPECT_EQ(result_of("continued"), result_of("fresh"));
}

TEST_F(StreamedRun, RendersOnlyWhatALaterStartAndALowerRateNeed) {
  const ProgramResult late =
      run("late", {"run", kPreset, "--start", "0.5", "--every", "2", "--max-frames", "5", "--variant", "vo"});
  EXPECT_EQ(late.exit_code, 0) << late.err;
  EXPECT_EQ(rendered_images(), 15 + 4 * 2 + 1);
}

}  // namespace
}  // namespace stillpoint
