// SPDX-License-Identifier: BSD-3-Clause
// Invalid input of `stillpoint run`: one error line, exit code 2, no partial output.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/rejection.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// A defect to introduce into a copy of a valid sequence.
struct Defect {
  std::string name;
  std::function<void(const fs::path& sequence)> introduce;
  std::vector<std::string> message_parts;
};

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

void append(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::app) << text; }

/// IMU samples from a time far before the images.
void shift_imu_time(const fs::path& sequence) {
  replace_file(sequence / "d400_gyroscope.txt", "1.0 0 0 0\n1.1 0 0 0\n");
  replace_file(sequence / "d400_accelerometer.txt", "1.0 0 0 9.8\n1.1 0 0 9.8\n");
}

void corrupt_all_images(const fs::path& sequence) {
  for (const fs::path& file : files_in(sequence / "color")) replace_file(file, "not an image");
}

/// Replaces all depth images by images of 1x1 pixels.
void shrink_depth(const fs::path& sequence) {
  const std::string tiny_pgm = "P5\n1 1\n65535\n\1\1";
  for (const fs::path& file : files_in(sequence / "aligned_depth")) replace_file(file, tiny_pgm);
}

const Defect kDefects[] = {
    {"EmptyImu",
     [](const fs::path& s) { replace_file(s / "d400_gyroscope.txt", ""); },
     {"d400_gyroscope.txt"}},
    {"UnsortedImu",
     [](const fs::path& s) { append(s / "d400_gyroscope.txt", "1700000000.5 0 0 0\n"); },
     {"d400_gyroscope.txt:"}},
    {"NanRow",
     [](const fs::path& s) { append(s / "d400_accelerometer.txt", "1700000009.0 nan 0 0\n"); },
     {"d400_accelerometer.txt:"}},
    {"NoTemporalOverlap", shift_imu_time, {"overlap"}},
    {"UnreadableCalibration",
     [](const fs::path& s) { replace_file(s / "sensors.yaml", "{ no: [yaml"); },
     {"sensors.yaml"}},
    {"MissingCalibration", [](const fs::path& s) { fs::remove(s / "sensors.yaml"); }, {"sensors.yaml"}},
    {"NoReadableImage", corrupt_all_images, {"color/"}},
    {"DepthImagesOfAnotherSize", shrink_depth, {"aligned_depth/"}},
    {"MissingImages", [](const fs::path& s) { fs::remove_all(s / "color"); }, {"color/"}},
};

class DefectiveSequence : public testing::TestWithParam<Defect> {};

TEST_P(DefectiveSequence, IsRejected) {
  const TemporaryFolder folder;
  const fs::path sequence = copy_of_rendered_sequence(folder);
  GetParam().introduce(sequence);
  const fs::path out = folder.path() / "out";
  const ProgramResult result = run_program({"run", sequence.string(), "--out", out.string()});
  expect_rejected(result, out, GetParam().message_parts);
}

INSTANTIATE_TEST_SUITE_P(BadInput, DefectiveSequence, testing::ValuesIn(kDefects),
                         [](const auto& defect) { return defect.param.name; });

TEST(BadInput, MissingFolder) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  expect_rejected(run_program({"run", "/no/such/folder", "--out", out.string()}), out,
                  {"sequence \"/no/such/folder\"", "neither a folder nor a preset"});
}

TEST(BadInput, FolderIsNotASequence) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  expect_rejected(run_program({"run", folder.path().string(), "--out", out.string()}), out,
                  {folder.path().string()});
}

TEST(BadInput, UnknownVariant) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  expect_rejected(
      run_program({"run", rendered_sequence().string(), "--variant", "wo_mask", "--out", out.string()}), out,
      {"config \"wo_mask\"", "did you mean \"ablations/wo_circular_mask\"?"});
}

TEST(BadInput, UnknownConfigKey) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const std::string config = folder.write("mine.toml", "\n[frontend]\nmax_feature = 3").string();
  expect_rejected(
      run_program({"run", rendered_sequence().string(), "--config", config, "--out", out.string()}), out,
      {config + ":3: unknown key \"frontend.max_feature\"; did you mean \"frontend.max_features\"?"});
}

TEST(BadInput, UnknownMode) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  expect_rejected(
      run_program({"run", rendered_sequence().string(), "--mode", "offline", "--out", out.string()}), out,
      {"--mode: \"offline\" is unknown"});
}

TEST(BadInput, UnwritableOutput) {
  const TemporaryFolder folder;
  const fs::path out = folder.write("file", "") / "out";
  expect_rejected(run_program({"run", rendered_sequence().string(), "--out", out.string()}), out,
                  {out.string() + ": cannot be created", "output folder"});
}

TEST(BadInput, FullDisk) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  ProgramOptions options;
  options.file_limit_bytes = 2000;  // smaller than the trajectory of 90 frames
  const ProgramResult result =
      run_program({"run", rendered_sequence().string(), "--variant", "vo", "--out", out.string()}, options);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("trajectory.tum: cannot be written: File too large"), std::string::npos)
      << result.err;
  EXPECT_TRUE(fs::is_empty(out));
}

}  // namespace
}  // namespace stillpoint
