// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint calibrate`: table, JSON, the rig file that it writes, and its errors.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iterator>
#include <numbers>
#include <regex>
#include <sstream>

#include <Eigen/Geometry>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "eval/io/text_reader.h"
#include "tests/support/program.h"
#include "tests/support/sequences/rendered_sequence.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> calibrate_with(const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {"calibrate", rendered_sequence().string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

nlohmann::json parameter_of(const std::string& json, const std::string& name) {
  const nlohmann::json document = nlohmann::json::parse(json);
  for (const nlohmann::json& entry : document["parameters"]) {
    if (entry["name"] == name) return entry;
  }
  return {};
}

TEST(CalibrateCommand, FindsAWrongFocalLengthAndWritesARigFile) {
  const TemporaryFolder out;
  const fs::path rig = out.path() / "rig.toml";
  const std::vector<std::string> fault = {"--fault", "focal_error:amount=4"};
  const ProgramResult result =
      run_program(calibrate_with({"--json", "--out", rig.string(), fault[0], fault[1]}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json fx = parameter_of(result.out, "fx");
  EXPECT_EQ(fx["outcome"], "differs");
  const double truth = fx["stated"].get<double>() / 1.04;
  EXPECT_LT(std::abs(fx["value"].get<double>() - truth), 3.0 * fx["sigma"].get<double>());
  EXPECT_LT(std::abs(fx["value"].get<double>() - truth), 0.01 * truth);

  const std::string text = eval::read_text_file(rig);
  EXPECT_NE(text.find("\ngyro_axes = ["), std::string::npos);
  for (const nlohmann::json& entry : nlohmann::json::parse(result.out)["parameters"]) {
    const auto name = entry["name"].get<std::string>();
    const bool is_marked = text.find("# " + name + ": not observed") != std::string::npos;
    EXPECT_TRUE(is_marked || entry["outcome"] != "not_observed" || !name.starts_with("T_b_c")) << text;
  }
  // The rig file is complete: with it the fault of the stated calibration is gone.
  const ProgramResult again = run_program(calibrate_with({"--json", "--rig", rig.string()}));
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NEAR(parameter_of(again.out, "fx")["stated"].get<double>(), fx["value"].get<double>(), 1e-9);
}

TEST(CalibrateCommand, KeepsWhatIsToBeKept) {
  const ProgramResult result = run_program(calibrate_with({"--keep", "focal", "--keep", "rolling_shutter"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out.find("fx"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("held out"), std::string::npos) << result.out;
}

TEST(CalibrateCommand, PointsToDiagnoseForAnExtrinsicThatIsFarOff) {
  const TemporaryFolder folder;
  const std::string rig =
      folder.write("rig.toml", "imu = { T_b_c = [0,-1,0,0, 1,0,0,0, 0,0,1,0, 0,0,0,1] }\n");
  const ProgramResult result = run_program(calibrate_with({"--rig", rig}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("far beyond its prior"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("`stillpoint diagnose`"), std::string::npos) << result.out;
  const ProgramResult stated = run_program(calibrate_with({}));
  ASSERT_EQ(stated.exit_code, 0) << stated.err;
  EXPECT_EQ(stated.out.find("far beyond its prior"), std::string::npos) << stated.out;
}

TEST(CalibrateCommand, NeverReplacesAFile) {
  const TemporaryFolder out;
  const fs::path rig = out.path() / "rig.toml";
  std::ofstream(rig) << "[camera]\nfx = 500\n";
  const ProgramResult result = run_program(calibrate_with({"--out", rig.string()}));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("rig.toml: already exists; remove it"), std::string::npos) << result.err;
  EXPECT_EQ(fs::file_size(rig), std::string("[camera]\nfx = 500\n").size());
}

TEST(CalibrateCommand, NamesTheParametersForAMistypedOne) {
  const ProgramResult result = run_program(calibrate_with({"--keep", "focus"}));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("focal"), std::string::npos) << result.err;
}

TEST(CalibrateCommand, WritesTheLastIterationWhenInterrupted) {
  const TemporaryFolder out;
  const fs::path rig = out.path() / "rig.yaml";
  const ProgramResult result =
      run_program(calibrate_with({"-v", "--out", rig.string(), "--out-format", "orb_slam"}),
                  {.interrupt_after = "iteration 2"});
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_NE(result.out.find("interrupted"), std::string::npos) << result.out;
  std::ostringstream text;
  text << std::ifstream(rig).rdbuf();
  EXPECT_NE(text.str().find("\n# interrupted"), std::string::npos) << text.str();
}

TEST(CalibrateCommand, TakesSeveralRecordingsOfADevice) {
  const TemporaryFolder folder;
  const std::string sequence = rendered_sequence().string(), copy = (folder.path() / "copy").string();
  fs::copy(sequence, copy, fs::copy_options::recursive);
  const ProgramResult one = run_program({"calibrate", sequence, "--json", "--max-frames", "60"});
  const ProgramResult two = run_program({"calibrate", sequence, copy, "--json", "--max-frames", "60"});
  ASSERT_EQ(two.exit_code, 0) << two.err;
  const nlohmann::json a = nlohmann::json::parse(one.out), b = nlohmann::json::parse(two.out);
  EXPECT_EQ(b["sequence"], a["sequence"].get<std::string>() + ", copy");
  EXPECT_EQ(run_program({"calibrate", sequence, sequence + "/."}).exit_code,
            2);  // its data would count twice
  EXPECT_EQ(b["keyframes"], 2 * a["keyframes"].get<int>());
}

TEST(CalibrateCommand, NamesTheRecordingsAndTheFieldOfDifferentDevicesBeforeItTracks) {
  const TemporaryFolder folder;
  const std::string sequence = rendered_sequence().string(), copy = (folder.path() / "copy").string(),
                    other = (folder.path() / "other").string();
  fs::copy(sequence, copy, fs::copy_options::recursive);
  fs::copy(sequence, other, fs::copy_options::recursive);
  std::ofstream(fs::path(other) / "rig.toml") << "[imu]\naccel_noise = 0.5\n";
  const ProgramResult result = run_program({"calibrate", sequence, copy, other});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find(sequence + ", " + other), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("[imu] accel_noise is "), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("tracking"), std::string::npos) << result.err;
}

/// The ground truth of the sequence in another world, of a frame turned by 90 degrees, 59 ms late.
void write_other_truth(const fs::path& file, double late_s) {
  std::ifstream in(rendered_sequence() / "groundtruth.txt");
  std::ofstream out(file);
  out << std::fixed << std::setprecision(9);
  for (std::string line; std::getline(in, line);) {
    std::istringstream row(line);
    double t = 0.0;
    Eigen::Vector3d p;
    Eigen::Quaterniond q;
    if (!(row >> t >> p.x() >> p.y() >> p.z() >> q.x() >> q.y() >> q.z() >> q.w())) continue;
    const Eigen::AngleAxisd world(1.0, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()),
        body(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX());
    p = world * p + Eigen::Vector3d(5.0, -3.0, 1.0);
    q = world * q * body;
    out << t + late_s << ' ' << p.transpose() << ' ' << q.coeffs().transpose() << '\n';
  }
}

TEST(CalibrateCommand, FindsTheDelayOfAGroundTruth) {
  const TemporaryFolder folder;
  const std::string truth = (folder.path() / "late.txt").string();
  write_other_truth(truth, 0.059);
  const ProgramResult result =
      run_program(calibrate_with({"--json", "--truth", truth, "--fault", "focal_error:amount=4"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json delay = parameter_of(result.out, "truth delay");
  EXPECT_NEAR(delay["value"].get<double>(), 59.0, std::min(3.0 * delay["sigma"].get<double>(), 3.0));
  const nlohmann::json fx = parameter_of(result.out, "fx");
  const double expected = fx["stated"].get<double>() / 1.04;
  EXPECT_NEAR(fx["value"].get<double>(), expected, 3.0 * fx["sigma"].get<double>());
}

TEST(CalibrateCommand, RejectsAGroundTruthOfAnotherTimeOrOfSeveralRecordings) {
  const TemporaryFolder folder;
  const std::string truth = (folder.path() / "late.txt").string();
  write_other_truth(truth, 100.0);
  const ProgramResult late = run_program(calibrate_with({"--truth", truth, "--max-frames", "30"}));
  EXPECT_EQ(late.exit_code, 2);
  EXPECT_NE(late.err.find("no poses at the time of the frames"), std::string::npos) << late.err;
  const ProgramResult several = run_program(calibrate_with({folder.path().string(), "--truth", truth}));
  EXPECT_EQ(several.exit_code, 2);
  EXPECT_NE(several.err.find("--truth"), std::string::npos) << several.err;
}

TEST(CalibrateCommand, DrawsTheResidualFieldBeforeAndAfterWithTheParameters) {
  const TemporaryFolder out;
  const fs::path plot = out.path() / "residuals.svg";
  const ProgramResult result =
      run_program(calibrate_with({"--plot", plot.string(), "--fault", "distortion_error:amount=0.1"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  // The pattern of the wrong distortion is gone in the second panel.
  std::ifstream figure(plot);
  const std::string svg{std::istreambuf_iterator<char>(figure), {}};
  const std::regex means("means of cells ([0-9.]+) px");
  std::vector<double> rms_px;
  for (std::sregex_iterator match(svg.begin(), svg.end(), means); match != std::sregex_iterator(); ++match)
    rms_px.push_back(std::stod((*match)[1]));
  ASSERT_EQ(rms_px.size(), 2U) << svg;
  EXPECT_LT(rms_px[1], 0.5 * rms_px[0]);
  EXPECT_NE(svg.find(">rolling_shutter_s<"), std::string::npos) << svg;  // the table of the parameters
  EXPECT_EQ(run_program(calibrate_with({"--plot", plot.string()})).exit_code, 2);  // not replaced
}

}  // namespace
}  // namespace stillpoint
