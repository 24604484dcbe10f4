// SPDX-License-Identifier: BSD-3-Clause
// Inputs and files of other origin are never overwritten, and lost output is an error.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "eval/io/openloris_file.h"
#include "eval/io/trajectory_file.h"
#include "tests/support/rejection.h"
#include "tests/support/sequences/rendered_sequence.h"
#include "tests/support/simulated/smooth_path.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct PathFiles {
  TemporaryFolder folder;
  std::string text = eval::format_tum(test::smooth_path(401, 0.05));
  std::string gt = folder.write("gt.txt", text).string();
  std::string est = folder.write("est.txt", text).string();

  [[nodiscard]] ProgramResult eval(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"eval", gt, est};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
};

TEST(EvalOutput, NeverOverwritesItsInputs) {
  const PathFiles files;
  const std::string svg = files.folder.write("gt.svg", files.text).string();
  expect_rejected(files.eval({"--plot", files.gt, "--force"}), {"gt.txt", ".svg, .pdf, .png"});
  expect_rejected(run_program({"eval", svg, files.est, "--plot", svg, "--force"}), {"gt.svg: is an input"});
  expect_rejected(files.eval({"--per-pose", files.gt, "--force"}), {"gt.txt: is an input"});
  expect_rejected(files.eval({"--per-pose", files.est, "--force"}), {"est.txt: is an input"});
  expect_rejected(files.eval({"--per-pose", svg, "--force"}),
                  {"gt.svg: exists and is a file of another kind"});
  for (const std::string& file : {files.gt, files.est, svg}) EXPECT_EQ(text_of(file), files.text) << file;
}

TEST(EvalOutput, ReplacesItsOwnFilesOnlyWithForce) {
  const PathFiles files;
  for (const char* name : {"plot.svg", "plot.png"}) {
    const std::string plot = (files.folder.path() / name).string();
    EXPECT_EQ(files.eval({"--plot", plot}).exit_code, 0);
    expect_rejected(files.eval({"--plot", plot}), {"already exists", "--force"});
    EXPECT_EQ(files.eval({"--plot", plot, "--force"}).exit_code, 0);
  }
}

TEST(RunOutput, IsNotWrittenIntoTheSequence) {
  const TemporaryFolder folder;
  const fs::path sequence = copy_of_rendered_sequence(folder);
  expect_rejected(run_program({"run", sequence.string(), "--out", sequence.string()}), {"is an input"});
  expect_rejected(run_program({"run", sequence.string(), "--out", (folder.path() / "out").string(), "--video",
                               sequence.string()}),
                  {"is an input"});
}

TEST(RunOutput, DoesNotReplaceFilesOfOtherPrograms) {
  const TemporaryFolder folder;
  const fs::path trajectory = folder.write("results/trajectory.tum", "1 0 0 0 0 0 0 1\n");
  const fs::path photo = folder.write("photos/images/000001.jpg", "photo");
  const std::string sequence = rendered_sequence().string();
  expect_rejected(run_program({"run", sequence, "--out", trajectory.parent_path().string()}),
                  {"trajectory.tum: exists, but not as part of an earlier output"});
  expect_rejected(
      run_program({"run", sequence, "--out", (folder.path() / "photos").string(), "--images", "2"}),
      {"images: exists"});
  expect_rejected(run_program({"run", sequence, "--out", (folder.path() / "out").string(), "--heartbeat",
                               trajectory.string(), "--max-frames", "10"}),
                  {"no heartbeat file"});
  EXPECT_EQ(text_of(trajectory), "1 0 0 0 0 0 0 1\n");
  EXPECT_EQ(text_of(photo), "photo");
}

TEST(RunOutput, ReplacesAnEarlierRunOnlyWithForce) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments = {
      "run", rendered_sequence().string(), "--out", folder.path().string(), "--max-frames", "10"};
  ASSERT_NE(run_program(arguments).exit_code, 2);
  expect_rejected(run_program(arguments), {"contains an earlier run", "--force"});
  arguments.insert(arguments.end(), {"--variant", "vo", "--force"});
  ASSERT_NE(run_program(arguments).exit_code, 2);
  EXPECT_NE(text_of(folder.path() / "manifest.json").find("\"vo\""), std::string::npos);
}

TEST(RunOutput, KeepsTheResultIfADumpFails) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments = {"run",          rendered_sequence().string(),
                                        "--out",        folder.path().string(),
                                        "--max-frames", "20",
                                        "--dump",       "cost",
                                        "--dump",       "labels"};
  const ProgramResult result = run_program(arguments);  // too short for a trend of the cost
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("warning: --dump cost: needs a run of 30 s"), std::string::npos) << result.err;
  for (const char* name : {"trajectory.tum", "result.json", "manifest.json", "labels.csv"})
    EXPECT_TRUE(fs::exists(folder.path() / name)) << name;
  EXPECT_FALSE(fs::exists(folder.path() / "cost.svg"));

  fs::remove(folder.path() / "labels.csv");
  fs::create_directory(folder.path() / "labels.csv");
  arguments.emplace_back("--force");
  const ProgramResult again = run_program(arguments);
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_NE(again.err.find("warning: --dump labels: "), std::string::npos) << again.err;
}

TEST(StandardOutput, IsAnErrorIfItCannotBeWritten) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"config", "list"}, {"plan", "list"}, {"--help"}, {"run", "--help"}}) {
    const ProgramResult result = run_program(arguments, {.out_file = "/dev/full"});
    EXPECT_EQ(result.exit_code, 2) << arguments[0];
    EXPECT_EQ(result.err,
              "stillpoint: error: standard output: cannot be written: No space left on device; "
              "free space and run it again\n");
  }
}

TEST(FileSizeLimit, IsAnErrorInsteadOfASignal) {
  const PathFiles files;
  const fs::path out = files.folder.path() / "errors.csv";
  const ProgramResult result =
      run_program({"eval", files.gt, files.est, "--per-pose", out.string()}, {.file_limit_bytes = 10'000});
  EXPECT_EQ(result.exit_code, 2) << 128 + SIGXFSZ << " is the signal";
  EXPECT_NE(result.err.find("errors.csv: cannot be written: File too large"), std::string::npos)
      << result.err;
  EXPECT_FALSE(fs::exists(out));
}

TEST(SpecialInputFiles, AreRejectedWithoutOpeningThem) {
  const TemporaryFolder folder;
  const fs::path sequence = copy_of_rendered_sequence(folder);
  const PathFiles files;
  const std::string pipe = (folder.path() / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_rejected(run_program({"eval", files.gt, pipe}), {"pipe: is a pipe"});
  expect_rejected(run_program({"eval", "/dev/zero", files.est}), {"/dev/zero: is a device"});
  expect_rejected(run_program({"plan", "show", pipe}), {"pipe"});
  expect_rejected(run_program({"store", "import", pipe, "--store", (folder.path() / "s").string()}),
                  {"is a pipe"});
  for (const char* name : {"d400_gyroscope.txt", "color.txt", "sensors.yaml"}) {
    const fs::path file = sequence / name;
    ASSERT_TRUE(fs::exists(file)) << name;
    const std::string text = text_of(file);
    fs::remove(file);
    ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
    expect_rejected(run_program({"run", sequence.string(), "--out", (folder.path() / "out").string()}),
                    {std::string(name) + ": is a pipe"});
    fs::remove(file);
    folder.write(file.lexically_relative(folder.path()), text);
  }
}

TEST(InvalidNames, AreRejectedWithTheirBytesEscaped) {
  const TemporaryFolder folder;
  const fs::path sequence = copy_of_rendered_sequence(folder);
  const fs::path invalid = folder.path() / "caf\xe9";
  fs::rename(sequence, invalid);
  expect_rejected(run_program({"run", invalid.string()}), {"caf\\xe9\"", "not valid UTF-8"});

  const eval::OpenlorisFile truth{
      .scene = "cafe", .frame = "base_link", .sequences = {{1, test::smooth_path(201, 0.05)}}};
  folder.write("truth/gt_cafe_1.txt", eval::format_openloris(truth));
  folder.write("results/sys\xff/cafe-1-1.txt", eval::format_openloris(truth));
  expect_rejected(run_program({"eval", "openloris", (folder.path() / "results").string(), "--ground-truth",
                               (folder.path() / "truth").string()}),
                  {"sys\\xff\"", "not valid UTF-8"});
}

}  // namespace
}  // namespace stillpoint
