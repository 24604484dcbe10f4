// SPDX-License-Identifier: BSD-3-Clause
// Whatever is wrong with what `stillpoint run` is given: one clear error, exit code 2, nothing half-written.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/refusal.h"
#include "tests/support/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// A fault that is put into a copy of a good sequence.
struct Fault {
  std::string name;
  std::function<void(const fs::path& sequence)> spoil;
  std::vector<std::string> message_parts;
};

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

void append(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::app) << text; }

/// Files that hold nothing but one line, far away in time.
void move_in_time(const fs::path& sequence) {
  replace_file(sequence / "d400_gyroscope.txt", "1.0 0 0 0\n1.1 0 0 0\n");
  replace_file(sequence / "d400_accelerometer.txt", "1.0 0 0 9.8\n1.1 0 0 9.8\n");
}

void spoil_all_pictures(const fs::path& sequence) {
  for (const fs::path& file : files_in(sequence / "color")) replace_file(file, "no picture");
}

/// Every depth picture becomes one of 1x1.
void shrink_depth(const fs::path& sequence) {
  const std::string tiny_pgm = "P5\n1 1\n65535\n\1\1";
  for (const fs::path& file : files_in(sequence / "aligned_depth")) replace_file(file, tiny_pgm);
}

const Fault kFaults[] = {
    {"EmptyImu",
     [](const fs::path& s) { replace_file(s / "d400_gyroscope.txt", ""); },
     {"d400_gyroscope.txt"}},
    {"UnsortedImu",
     [](const fs::path& s) { append(s / "d400_gyroscope.txt", "1700000000.5 0 0 0\n"); },
     {"d400_gyroscope.txt:"}},
    {"NanRow",
     [](const fs::path& s) { append(s / "d400_accelerometer.txt", "1700000009.0 nan 0 0\n"); },
     {"d400_accelerometer.txt:"}},
    {"NoOverlapInTime", move_in_time, {"overlap"}},
    {"UnreadableCalibration",
     [](const fs::path& s) { replace_file(s / "sensors.yaml", "{ no: [yaml"); },
     {"sensors.yaml"}},
    {"MissingCalibration", [](const fs::path& s) { fs::remove(s / "sensors.yaml"); }, {"sensors.yaml"}},
    {"NoPictureReadable", spoil_all_pictures, {"color/"}},
    {"DepthOfAnotherSize", shrink_depth, {"aligned_depth/"}},
    {"MissingPictures", [](const fs::path& s) { fs::remove_all(s / "color"); }, {"color/"}},
};

class SpoiltSequence : public testing::TestWithParam<Fault> {};

TEST_P(SpoiltSequence, IsRefused) {
  const TemporaryFolder folder;
  const fs::path sequence = copy_of_rendered_sequence(folder);
  GetParam().spoil(sequence);
  const fs::path out = folder.path() / "out";
  const ProgramResult result = run_program({"run", sequence.string(), "--out", out.string()});
  expect_refused(result, out, GetParam().message_parts);
}

INSTANTIATE_TEST_SUITE_P(BadInput, SpoiltSequence, testing::ValuesIn(kFaults),
                         [](const auto& fault) { return fault.param.name; });

TEST(BadInput, MissingFolder) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  expect_refused(run_program({"run", "/no/such/folder", "--out", out.string()}), out,
                 {"sequence \"/no/such/folder\"", "neither a folder nor a preset"});
}

TEST(BadInput, FolderThatIsNoSequence) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  expect_refused(run_program({"run", folder.path().string(), "--out", out.string()}), out,
                 {folder.path().string()});
}

TEST(BadInput, UnknownVariant) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  expect_refused(
      run_program({"run", rendered_sequence().string(), "--variant", "wo_mask", "--out", out.string()}), out,
      {"config \"wo_mask\"", "did you mean \"ablations/wo_circular_mask\"?"});
}

TEST(BadInput, UnknownConfigKey) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const std::string config = folder.write("mine.toml", "\n[frontend]\nmax_feature = 3").string();
  expect_refused(
      run_program({"run", rendered_sequence().string(), "--config", config, "--out", out.string()}), out,
      {config + ":3: unknown key \"frontend.max_feature\"; did you mean \"frontend.max_features\"?"});
}

TEST(BadInput, UnknownMode) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  expect_refused(
      run_program({"run", rendered_sequence().string(), "--mode", "psychic", "--out", out.string()}), out,
      {"--mode: \"psychic\" is not known"});
}

TEST(BadInput, UnwritableOutput) {
  const TemporaryFolder folder;
  const fs::path out = folder.write("file", "") / "out";
  expect_refused(run_program({"run", rendered_sequence().string(), "--out", out.string()}), out,
                 {out.string() + ": cannot be made", "--out"});
}

TEST(BadInput, FullDisk) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  ProgramOptions options;
  options.file_limit_bytes = 2000;  // less than the trajectory of 90 frames needs
  const ProgramResult result =
      run_program({"run", rendered_sequence().string(), "--variant", "vo", "--out", out.string()}, options);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("trajectory.tum: cannot be written: File too large"), std::string::npos)
      << result.err;
  EXPECT_TRUE(fs::is_empty(out));
}

}  // namespace
}  // namespace stillpoint
