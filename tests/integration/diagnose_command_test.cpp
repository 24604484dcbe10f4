// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint diagnose`: causes in order of their measured effect, silence on a sound sequence, and its
// errors.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

ProgramResult diagnosis_of(const fs::path& folder, const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {"diagnose", folder.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

std::string first_cause(const ProgramResult& result) {
  const nlohmann::json document = nlohmann::json::parse(result.out);
  return document["causes"].empty() ? "" : document["causes"][0]["id"].get<std::string>();
}

TEST(DiagnoseCommand, IsSilentAboutASoundSequence) {
  const ProgramResult result = diagnosis_of(rendered_sequence(), {});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("nothing found that changes the error by more than"), std::string::npos)
      << result.out;
}

TEST(DiagnoseCommand, NamesDepthOfAWrongScaleFirst) {
  const ProgramResult result = diagnosis_of(
      rendered_sequence(), {"--json", "--fault", "depth_scaled:amount=0.8,start=0,duration=100"});
  ASSERT_EQ(result.exit_code, 1) << result.out << result.err;
  EXPECT_EQ(first_cause(result), "depth_scale") << result.out;
}

// The inconsistency is relative to the stated noise, so that stating more reduces it in any case.
TEST(DiagnoseCommand, DoesNotMeasureNoiseByTheInconsistency) {
  const TemporaryFolder folder;
  const fs::path copy = copy_of_rendered_sequence(folder);
  fs::remove(copy / "groundtruth.txt");
  const ProgramResult result = diagnosis_of(copy, {"--json", "--fault", "imu_noise:amount=5"});
  const nlohmann::json document = nlohmann::json::parse(result.out);
  EXPECT_EQ(document["measure"], "inconsistency");
  for (const nlohmann::json& cause : document["causes"]) EXPECT_NE(cause["id"], "imu_noise") << result.out;
  bool is_listed = false;
  for (const nlohmann::json& cause : document["others"])
    is_listed = is_listed || (cause["id"] == "imu_noise" && cause["error_ratio"].is_null());
  EXPECT_TRUE(is_listed) << result.out;
}

/// Multiplies the columns after the stamps.
void scale_columns(const fs::path& file, double factor) {
  std::ifstream in(file);
  std::string text, line;
  while (std::getline(in, line)) {
    if (!line.starts_with("#")) {
      std::istringstream row(line);
      std::string t;
      double x = 0.0, y = 0.0, z = 0.0;
      row >> t >> x >> y >> z;
      std::ostringstream changed;
      changed.precision(12);
      changed << t << ' ' << factor * x << ' ' << factor * y << ' ' << factor * z;
      line = changed.str();
    }
    text += line + '\n';
  }
  in.close();
  fs::remove(file);
  std::ofstream(file) << text;
}

TEST(DiagnoseCommand, NamesAGyroscopeInDegreesFirst) {
  const TemporaryFolder folder;
  const fs::path copy = copy_of_rendered_sequence(folder);
  scale_columns(copy / "d400_gyroscope.txt", 180.0 / M_PI);
  const ProgramResult result = diagnosis_of(copy, {});
  ASSERT_EQ(result.exit_code, 1) << result.out << result.err;
  EXPECT_NE(result.out.find("1. gyroscope in deg/s"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("0.01745329"), std::string::npos) << result.out;
  EXPECT_LE(std::ranges::count(result.out, '\n'), 15) << result.out;
}

/// Rates beyond the range of gyroscopes, which no other command reads.
TEST(DiagnoseCommand, NamesTheUnitOfARecordingThatCannotBeRead) {
  const TemporaryFolder folder;
  const fs::path copy = copy_of_rendered_sequence(folder);
  scale_columns(copy / "d400_gyroscope.txt", 1e5);
  const ProgramResult result = diagnosis_of(copy, {});
  ASSERT_EQ(result.exit_code, 1) << result.out << result.err;
  EXPECT_NE(result.out.find("1. gyroscope in deg/s"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("d400_gyroscope.txt:"), std::string::npos) << result.out;
  const ProgramResult json = diagnosis_of(copy, {"--json"});
  ASSERT_EQ(json.exit_code, 1) << json.err;
  EXPECT_EQ(nlohmann::json::parse(json.out).at("others").at(0).at("id"), "gyro_unit");
}

/// A window that does not fit once claimed that the focal length is 80 % off.
TEST(DiagnoseCommand, TheLineOfARunWithoutPosesSaysNothingAboutTheRig) {
  const TemporaryFolder folder;
  const fs::path copy = copy_of_rendered_sequence(folder);
  scale_columns(copy / "d400_gyroscope.txt", 180.0 / M_PI);
  const fs::path out = folder.path() / "out";
  const ProgramResult result = run_program({"run", copy.string(), "--out", out.string()});
  ASSERT_EQ(result.exit_code, 1) << result.out << result.err;
  EXPECT_NE(result.out.find("100 % of the frames after the first second have no pose: `stillpoint diagnose"),
            std::string::npos)
      << result.out;
  EXPECT_EQ(result.out.find("differs"), std::string::npos) << result.out;
  EXPECT_TRUE(nlohmann::json::parse(std::ifstream(out / "result.json")).at("rig_report").empty());
}

/// Adds 15 cm to the x coordinates of the second half.
void plant_jump(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  in.close();
  fs::remove(file);
  std::ofstream out(file);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::istringstream row(lines[i]);
    std::string t, rest;
    double x = 0.0;
    if (2 * i < lines.size() || !(row >> t >> x) || !std::getline(row, rest)) {
      out << lines[i] << '\n';
    } else {
      out << t << ' ' << x + 0.15 << rest << '\n';
    }
  }
}

/// With 90 images neither clock nor frame nor scale of the truth are determined; it once said that nothing
/// contradicts the truth.
TEST(DiagnoseCommand, TellsAJumpOfTheTruthInItsRow) {
  const ProgramResult sound = diagnosis_of(rendered_sequence(), {"--truth"});
  EXPECT_EQ(sound.exit_code, 3) << sound.out << sound.err;
  EXPECT_NE(sound.out.find("nothing could be compared"), std::string::npos) << sound.out;
  EXPECT_EQ(sound.out.find("contradict"), std::string::npos) << sound.out;
  const ProgramResult json = diagnosis_of(rendered_sequence(), {"--truth", "--json"});
  EXPECT_EQ(json.exit_code, 2) << json.out;
  EXPECT_NE(json.err.find("--json"), std::string::npos) << json.err;
  const TemporaryFolder folder;
  const fs::path copy = copy_of_rendered_sequence(folder);
  plant_jump(copy / "groundtruth.txt");
  const ProgramResult jump = diagnosis_of(copy, {"--truth"});
  EXPECT_EQ(jump.exit_code, 1) << jump.out << jump.err;
  EXPECT_NE(jump.out.find("ground truth jumps: 1 step(s)"), std::string::npos) << jump.out;
}

/// A run of the sequence. @return its folder
fs::path run_of(const fs::path& sequence, const TemporaryFolder& folder,
                const std::vector<std::string>& more = {}) {
  const fs::path out = folder.path() / "run";
  std::vector<std::string> arguments = {"run", sequence.string(), "--out", out.string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const ProgramResult result = run_program(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  return out;
}

TEST(DiagnoseCommand, TakesAFinishedRunInPlaceOfTheFirstOne) {
  const TemporaryFolder folder;
  const std::vector<std::string> fault = {"--fault", "depth_scaled:amount=0.8,start=0,duration=100"};
  const fs::path run = run_of(rendered_sequence(), folder, fault);
  const double ate_m =
      nlohmann::json::parse(std::ifstream(run / "result.json")).at("ate_rmse_m").get<double>();
  const ProgramResult result =
      diagnosis_of(rendered_sequence(), {run.string(), "--json", fault[0], fault[1]});
  ASSERT_EQ(result.exit_code, 1) << result.out << result.err;
  EXPECT_EQ(first_cause(result), "depth_scale") << result.out;
  const nlohmann::json document = nlohmann::json::parse(result.out);
  EXPECT_TRUE(document.at("finished_run").get<bool>());
  EXPECT_NEAR(document.at("error").get<double>(), ate_m, 1e-6 * ate_m);
}

TEST(DiagnoseCommand, RefusesARunOfAnotherSequenceConfigOrPart) {
  const TemporaryFolder folder;
  const fs::path run = run_of(rendered_sequence(), folder, {"--max-frames", "40"});
  const auto refusal = [&](const fs::path& sequence, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {run.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = diagnosis_of(sequence, arguments);
    EXPECT_EQ(result.exit_code, 2) << result.out << result.err;
    return result.err;
  };
  EXPECT_NE(
      refusal(rendered_sequence(), {"--set", "backend.max_iterations=3"}).find("backend.max_iterations = "),
      std::string::npos);
  EXPECT_NE(refusal(rendered_sequence(), {"--start", "0.5"}).find("--start"), std::string::npos);
  EXPECT_NE(refusal(rendered_sequence(), {"--fault", "blank:start=1,duration=1"}).find("--fault"),
            std::string::npos);
  const fs::path rig = folder.write("rig.toml", "[depth]\nscale = 1000\n");
  EXPECT_NE(refusal(rendered_sequence(), {"--rig", rig.string()}).find("another calibration"),
            std::string::npos);
  const fs::path other = copy_of_rendered_sequence(folder);
  scale_columns(other / "d400_gyroscope.txt", 1.001);
  EXPECT_NE(refusal(other, {}).find("other files"), std::string::npos);
  fs::remove(run / "status.csv");
  EXPECT_NE(refusal(rendered_sequence(), {}).find("status.csv"), std::string::npos);
}

TEST(DiagnoseCommand, TakesAStoredRun) {
  const TemporaryFolder folder;
  folder.write("one.toml",
               "title = \"One run\"\nbase = \"stillpoint\"\nvariants = [\"stillpoint\"]\n"
               "seeds = [1]\n[recorded]\nsequences = [\"" +
                   rendered_sequence().string() + "\"]\n");
  const std::string store = (folder.path() / "store.sqlite").string();
  const ProgramResult bench = run_program({"bench", (folder.path() / "one.toml").string(), "--store", store});
  ASSERT_EQ(bench.exit_code, 0) << bench.out << bench.err;
  const ProgramResult list = run_program({"store", "list", store});
  const std::string key = list.out.substr(0, list.out.find(' '));
  const ProgramResult result =
      diagnosis_of(rendered_sequence(), {key.substr(0, 8), "--store", store, "--budget", "20s"});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("the given run and"), std::string::npos) << result.out;
  const ProgramResult unknown = diagnosis_of(rendered_sequence(), {"ffffffff", "--store", store});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("store list"), std::string::npos) << unknown.err;
}

/// A stored run of a system that copies a trajectory.
/// @return the key of the run
std::string run_of_other_system(const fs::path& trajectory, const fs::path& store,
                                const TemporaryFolder& folder) {
  folder.write("copy.toml", "name = \"copy\"\ncommand = [\"cp\", \"" + trajectory.string() +
                                "\", \"{out}/trajectory.tum\"]\nlayout = \"as_is\"\n");
  const fs::path plan = folder.write(
      "plan.toml", "title = \"Copy\"\nvariants = []\nseeds = [1]\nsystems = [\"" +
                       (folder.path() / "copy.toml").string() + "\"]\n[recorded]\nsequences = [\"" +
                       rendered_sequence().string() + "\"]\n");
  const ProgramResult bench = run_program({"bench", plan.string(), "--store", store.string()});
  EXPECT_EQ(bench.exit_code, 0) << bench.out << bench.err;
  const ProgramResult list = run_program({"store", "list", store.string()});
  return list.out.substr(0, list.out.find(' '));
}

TEST(DiagnoseCommand, TellsWhatDataRunAndTruthTellOfAnotherSystem) {
  const TemporaryFolder folder;
  const fs::path trajectory = run_of(rendered_sequence(), folder) / "trajectory.tum";
  const fs::path store = folder.path() / "store.sqlite";
  const std::string key = run_of_other_system(trajectory, store, folder);
  const ProgramResult sound = diagnosis_of(rendered_sequence(), {key, "--store", store.string()});
  EXPECT_EQ(sound.exit_code, 0) << sound.out << sound.err;
  EXPECT_NE(sound.out.find("the given run and 0 trials"), std::string::npos) << sound.out;
  const ProgramResult set =
      diagnosis_of(rendered_sequence(), {key, "--store", store.string(), "--set", "imu.gyro_noise=0.01"});
  EXPECT_EQ(set.exit_code, 2) << set.out;
  EXPECT_NE(set.err.find("--set: has no effect"), std::string::npos) << set.err;
  const ProgramResult faulty = diagnosis_of(
      rendered_sequence(), {key, "--store", store.string(), "--fault", "blank:start=1,duration=1"});
  EXPECT_EQ(faulty.exit_code, 2) << faulty.out;
  EXPECT_NE(faulty.err.find("store extract"), std::string::npos) << faulty.err;

  const fs::path copy = copy_of_rendered_sequence(folder);
  scale_columns(copy / "d400_gyroscope.txt", 180.0 / M_PI);
  const ProgramResult degrees = diagnosis_of(copy, {trajectory.string()});
  EXPECT_EQ(degrees.exit_code, 1) << degrees.out << degrees.err;
  EXPECT_NE(degrees.out.find("- gyroscope in deg/s"), std::string::npos) << degrees.out;
  EXPECT_NE(degrees.out.find("leave RUN out"), std::string::npos) << degrees.out;
  plant_jump(copy / "groundtruth.txt");
  const ProgramResult truth = diagnosis_of(copy, {trajectory.string(), "--truth"});
  EXPECT_EQ(truth.exit_code, 1) << truth.out << truth.err;
  EXPECT_NE(truth.out.find("ground truth jumps: 1 step(s)"), std::string::npos) << truth.out;

  const fs::path late = folder.write("late.tum", "9e9 0 0 0 0 0 0 1\n");
  const ProgramResult elsewhere = diagnosis_of(copy, {late.string()});
  EXPECT_EQ(elsewhere.exit_code, 2);
  EXPECT_NE(elsewhere.err.find("no pose at the time of a frame"), std::string::npos) << elsewhere.err;
}

TEST(DiagnoseCommand, NamesTheProblemOfABudgetWithoutUnit) {
  const ProgramResult result = diagnosis_of(rendered_sequence(), {"--budget", "60"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("--budget: \"60\""), std::string::npos) << result.err;
}

TEST(DiagnoseCommand, RejectsAPartWithTooFewFrames) {
  const ProgramResult result = diagnosis_of(rendered_sequence(), {"--start", "2.8"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("frames"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace stillpoint
