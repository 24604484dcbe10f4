// SPDX-License-Identifier: BSD-3-Clause
// Data that a run could take for better than it is: missing boxes, defective inertial data, repeated stamps.
// It is rejected, or counted and reported.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "eval/io/trajectory_file.h"
#include "tests/support/program.h"
#include "tests/support/rejection.h"
#include "tests/support/sequences/rendered_sequence.h"
#include "tests/support/simulated/smooth_path.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 90;

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Keeps the lines of a file for which `is_kept(line)`.
template <class Predicate>
void filter_lines(const fs::path& file, const Predicate& is_kept) {
  std::string text;
  for (const std::string& line : lines_of(file)) {
    if (is_kept(line)) text += line + "\n";
  }
  replace_file(file, text);
}

double stamp_of(const std::string& line) { return line.starts_with('#') ? 0.0 : std::stod(line); }

/// A modifiable sequence, and runs on it.
struct FaultySequence {
  [[nodiscard]] ProgramResult run(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"run", sequence.string(), "--out", out.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  [[nodiscard]] nlohmann::json result() const {
    return nlohmann::json::parse(std::ifstream(out / "result.json"));
  }
  [[nodiscard]] ProgramResult bench(const std::string& variant) const {
    const fs::path plan =
        folder.write("plan.toml", "[recorded]\nsequences = [\"copy\"]\nvariants = [\"" + variant + "\"]\n");
    ProgramOptions options;
    options.environment = {"STILLPOINT_DATA=" + folder.path().string(),
                           "STILLPOINT_REGISTRY=" + (folder.path() / "none.json").string()};
    return run_program(
        {"bench", plan.string(), "--out", out.string(), "--store", (folder.path() / "store.sqlite").string()},
        options);
  }

  TemporaryFolder folder;
  fs::path sequence = copy_of_rendered_sequence(folder);
  fs::path out = folder.path() / "out";
};

std::string warnings_of(const nlohmann::json& result) {
  std::string text;
  for (const auto& warning : result.at("warnings")) text += warning.get<std::string>() + "\n";
  return text;
}

TEST(MissingBoxes, ARunThatUsesThemIsRejectedWithTheRemedies) {
  const FaultySequence data;
  fs::remove(data.sequence / "detections.txt");
  expect_rejected(data.run(), data.out,
                  {"copy/detections.txt: does not exist", "stillpoint detect", "--set detector.kind=none"});
  expect_rejected(data.run({"--variant", "baselines/vins_rgbd", "--variant", "vo"}), data.out,
                  {"copy/detections.txt"});
  replace_file(data.sequence / "detections.txt", "# no rows\n");
  expect_rejected(data.run(), data.out, {"copy/detections.txt: none of its 0 time stamps"});
}

TEST(MissingBoxes, ARunWithoutADetectorNeedsNone) {
  const FaultySequence data;
  fs::remove(data.sequence / "detections.txt");
  const ProgramResult result =
      data.run({"--variant", "vo", "--set", "detector.kind=none", "--max-frames", "20"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(data.result().at("frames_without_boxes").is_null());
}

TEST(MissingBoxes, APlanIsRejectedBeforeItsFirstRun) {
  const FaultySequence data;
  fs::remove(data.sequence / "detections.txt");
  expect_rejected(data.bench("vo"), {"run \"copy vo\"", "copy/detections.txt: does not exist",
                                     "stillpoint detect", "detector.kind=none"});
  const ProgramResult without = data.bench("vo+wo_object_detection");
  EXPECT_EQ(without.exit_code, 0) << without.err;
}

TEST(MissingBoxes, OfSomeFramesAreCountedAndReported) {
  const FaultySequence data;
  const std::vector<std::string> lines = lines_of(data.sequence / "detections.txt");
  const double first = stamp_of(lines[1]);  // after the header
  filter_lines(data.sequence / "detections.txt",
               [&](const std::string& line) { return stamp_of(line) < first + 0.99; });
  const ProgramResult result = data.run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  // Frames at 30 Hz: those at 0 to 29/30 s keep their boxes.
  EXPECT_NE(result.err.find("warning: detections: 60 of 90 frames have no recorded boxes"), std::string::npos)
      << result.err;
  EXPECT_EQ(data.result().at("frames_without_boxes"), kFrames - 30);
  EXPECT_NEAR(data.result().at("detector").at("fraction_without_boxes"), 2.0 / 3.0, 1e-9);
  const ProgramResult bench = data.bench("vo");
  EXPECT_EQ(bench.exit_code, 0) << bench.err;
  EXPECT_NE(bench.out.find("no recorded boxes in 60 of 90 frames"), std::string::npos) << bench.out;
}

TEST(InertialData, ValuesBeyondAnySensorAreRejected) {
  const FaultySequence data;
  std::vector<std::string> lines = lines_of(data.sequence / "d400_gyroscope.txt");
  lines[500] = lines[500].substr(0, lines[500].find(' ')) + " 1e30 0 0";
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  replace_file(data.sequence / "d400_gyroscope.txt", text);
  expect_rejected(data.run(), data.out, {"d400_gyroscope.txt:501", "exceeds 100 rad/s"});
  const ProgramResult check = run_program({"data", "check", data.sequence.string()});
  EXPECT_EQ(check.exit_code, 1);
  EXPECT_NE(check.out.find("exceeds 100 rad/s"), std::string::npos) << check.out;
}

TEST(InertialData, AGapOfASecondIsReported) {
  for (const char* file : {"d400_gyroscope.txt", "d400_accelerometer.txt"}) {
    const FaultySequence data;
    const double first = stamp_of(lines_of(data.sequence / "detections.txt")[1]);
    filter_lines(data.sequence / file, [&](const std::string& line) {
      return stamp_of(line) < first + 1.5 || stamp_of(line) > first + 2.5;
    });
    const ProgramResult result = data.run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find("warning: imu: 1 gap(s)"), std::string::npos) << file << result.err;
    EXPECT_EQ(data.result().at("imu_health").at("gaps"), 1) << file;
    EXPECT_NE(warnings_of(data.result()).find("imu: 1 gap(s)"), std::string::npos);
    const ProgramResult check = run_program({"data", "check", data.sequence.string()});
    EXPECT_EQ(check.exit_code, 1);
    EXPECT_NE(check.out.find("warning: imu: 1 gap(s)"), std::string::npos) << check.out;
  }
}

TEST(RepeatedStamps, OfTheGroundTruthAreSkippedAndReportedByEachCommand) {
  const FaultySequence data;
  std::vector<std::string> lines = lines_of(data.sequence / "groundtruth.txt");
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) text += lines[i] + "\n" + (i == 9 ? lines[i] + "\n" : "");
  replace_file(data.sequence / "groundtruth.txt", text);
  const std::string warning = "ground truth: 1 row skipped: the time stamp repeats";
  const ProgramResult run = data.run({"--max-frames", "30"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("warning: " + warning), std::string::npos) << run.err;
  EXPECT_NE(warnings_of(data.result()).find(warning), std::string::npos);
  ProgramOptions options;
  options.environment = {"STILLPOINT_REGISTRY=" + (data.folder.path() / "registry.json").string()};
  const ProgramResult add = run_program({"data", "add", "mine", data.sequence.string()}, options);
  EXPECT_EQ(add.exit_code, 0) << add.err;
  EXPECT_NE(add.err.find("warning: " + warning), std::string::npos) << add.err;
  const ProgramResult check = run_program({"data", "check", data.sequence.string()});
  EXPECT_EQ(check.exit_code, 1);
  EXPECT_NE(check.out.find("warning: " + warning), std::string::npos) << check.out;
}

/// Ground truth and estimate of a smooth path at 20 Hz over 10 s.
struct PathFiles {
  TemporaryFolder folder;
  std::string poses = eval::format_tum(test::smooth_path(201, 0.05));
  std::string gt = folder.write("gt.txt", poses).string();
};

TEST(RepeatedStamps, OfAnEstimateAreSkippedAndReportedByEval) {
  const PathFiles files;
  const std::string last_row = files.poses.substr(files.poses.rfind('\n', files.poses.size() - 2) + 1);
  const std::string est = files.folder.write("est.txt", files.poses + last_row + last_row).string();
  const ProgramResult result = run_program({"eval", files.gt, est, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("est.txt: 2 rows skipped: the time stamp repeats"), std::string::npos)
      << result.err;
  const nlohmann::json rows = nlohmann::json::parse(result.out).at("rows");
  EXPECT_EQ(rows.at("estimate").at("repeated_stamps"), 2);
  EXPECT_EQ(rows.at("ground_truth").at("repeated_stamps"), 0);
}

TEST(EvalInput, WithoutOverlapInTimeIsRejected) {
  const PathFiles files;
  const std::string est =
      files.folder.write("est.txt", eval::format_tum(test::smooth_path(201, 0.05, 1000.0))).string();
  expect_rejected(run_program({"eval", files.gt, est}),
                  {"est.txt: covers", "no overlap in time", "--offset"});
  const ProgramResult shifted = run_program({"eval", files.gt, est, "--offset", "-1000"});
  EXPECT_EQ(shifted.exit_code, 0) << shifted.err;
}

TEST(EvalInput, WithoutMatchedPosesIsRejected) {
  const PathFiles files;
  const std::string est =
      files.folder.write("est.txt", eval::format_tum(test::smooth_path(201, 0.05, 0.02))).string();
  expect_rejected(
      run_program({"eval", files.gt, est, "--protocol", "compat:tum", "--max-difference", "0.001"}),
      {"est.txt", "close enough in time", "--max-difference"});
}

}  // namespace
}  // namespace stillpoint
