// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint run` with the frame cache, and `stillpoint data cache`.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class FrameCacheCommand : public ::testing::Test {
 protected:
  [[nodiscard]] ProgramResult execute(const std::vector<std::string>& arguments) const {
    return run_program(arguments, {.environment = {"STILLPOINT_CACHE=" + (folder_.path() / "cache").string(),
                                                   "STILLPOINT_CACHE_SIZE=100M"}});
  }

  /// Runs the sequence with annotated images. @return output folder
  [[nodiscard]] fs::path run(const std::string& name, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {
        "run", rendered_sequence().string(), "--out", out(name), "--images", "2", "--dump", "labels"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = execute(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.find("cache"), std::string::npos) << result.err;
    return out(name);
  }
  [[nodiscard]] std::string out(const std::string& name) const { return (folder_.path() / name).string(); }

  TemporaryFolder folder_;
};

void expect_equal_outputs(const fs::path& a, const fs::path& b) {
  for (const char* file : {"trajectory.tum", "labels.csv", "counters.csv"})
    EXPECT_EQ(text_of(a / file), text_of(b / file)) << file;
  int images = 0;
  for (const fs::directory_entry& image : fs::directory_iterator(a / "images")) {
    EXPECT_EQ(text_of(image.path()), text_of(b / "images" / image.path().filename()));
    ++images;
  }
  EXPECT_EQ(images, 2);
}

TEST_F(FrameCacheCommand, ResultsDoNotDependOnTheCache) {
  const fs::path without = run("without", {"--no-frame-cache"});
  EXPECT_FALSE(fs::exists(folder_.path() / "cache" / "frames"));
  const fs::path first = run("first");
  const fs::path second = run("second");
  expect_equal_outputs(without, first);
  expect_equal_outputs(without, second);
}

// The maximum is over all finished processes, so the order matters.
TEST_F(FrameCacheCommand, TheCacheNeedsNoMoreThanTenPercentMoreMemory) {
  const auto peak_kB = [] {
    rusage usage{};
    ::getrusage(RUSAGE_CHILDREN, &usage);
    return usage.ru_maxrss;
  };
  static_cast<void>(run("without", {"--no-frame-cache"}));
  const long without = peak_kB();
  static_cast<void>(run("first"));
  static_cast<void>(run("second"));
  EXPECT_LE(static_cast<double>(peak_kB()), 1.1 * static_cast<double>(without));
}

TEST_F(FrameCacheCommand, ListsSizesAndPrunes) {
  static_cast<void>(run("first"));
  const std::string name = rendered_sequence().filename().string();
  const ProgramResult list = execute({"data", "cache", "list"});
  EXPECT_NE(list.out.find(name), std::string::npos) << list.out;
  EXPECT_NE(list.out.find("90 frames"), std::string::npos) << list.out;
  const ProgramResult size = execute({"data", "cache", "size"});
  EXPECT_NE(size.out.find("of 100 MB in 1 file,"), std::string::npos) << size.out;
  EXPECT_EQ(execute({"data", "cache", "prune", "--size", "0"}).exit_code, 0);
  EXPECT_EQ(execute({"data", "cache", "list"}).out, "");
}

TEST_F(FrameCacheCommand, TheStoredLimitHoldsWithoutTheVariable) {
  const std::string cache = "STILLPOINT_CACHE=" + (folder_.path() / "cache").string();
  EXPECT_EQ(execute({"data", "cache", "size", "--limit", "3G"}).exit_code, 0);
  const ProgramResult stored =
      run_program({"data", "cache", "size"}, {.environment = {cache, "STILLPOINT_CACHE_SIZE="}});
  EXPECT_NE(stored.out.find("of 3 GB"), std::string::npos) << stored.out << stored.err;
  const ProgramResult wrong =
      run_program({"data", "cache", "size", "--limit", "much"}, {.environment = {cache}});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("is not a size"), std::string::npos) << wrong.err;
}

}  // namespace
}  // namespace stillpoint
