// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include <opencv2/core.hpp>

#include "core/geometry/so3.h"
#include "datasets/io/image_io.h"
#include "eval/io/openloris_file.h"
#include "eval/io/trajectory_file.h"
#include "tests/support/program.h"
#include "tests/support/simulated/smooth_path.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

/// Ground truth at 100 Hz and estimate at 20 Hz of a smooth path of 20 s.
struct PathFiles {
  TemporaryFolder folder;
  std::string gt = folder.write("gt.txt", eval::format_tum(test::smooth_path(2001, 0.01))).string();
  std::string est = folder.write("est.txt", eval::format_tum(test::smooth_path(401, 0.05))).string();
};

TEST(EvalCommand, ExplainsItsProtocols) {
  const PathFiles files;
  const ProgramResult result = run_program({"eval", files.gt, files.est, "--explain"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("\ncompat:tum (version 1): ATE:"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\nstrict:se3 (version 1): "), std::string::npos);
}

TEST(EvalCommand, RanksAFailedRunLast) {
  const PathFiles files;
  const std::string lost =
      files.folder.write("lost.txt", eval::format_tum(test::smooth_path(41, 0.05))).string();
  const ProgramResult result = run_program({"eval", files.gt, lost, files.est, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto ranking = nlohmann::json::parse(result.out).at("comparison").at("ranking");
  EXPECT_EQ(ranking.at(0).at("estimate"), "est.txt");
  EXPECT_EQ(ranking.at(1).at("estimate"), "lost.txt");
  EXPECT_EQ(ranking.at(1).at("failed"), true);
}

TEST(EvalCommand, WritesAPlotAndTheErrorsOfAllPoses) {
  const PathFiles files;
  const std::filesystem::path plot = files.folder.path() / "plot.svg";
  const std::filesystem::path errors = files.folder.path() / "errors.csv";
  const ProgramResult result = run_program({"eval", files.gt, files.est, "--protocol", "strict:se3", "--plot",
                                            plot.string(), "--per-pose", errors.string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::ifstream svg(plot);
  std::string first_line;
  std::getline(svg, first_line);
  EXPECT_TRUE(first_line.starts_with("<svg")) << first_line;
  std::ifstream csv(errors);
  long lines = 0;
  for (std::string line; std::getline(csv, line);) ++lines;
  EXPECT_EQ(lines, 1 + 401);  // the header and all poses
}

// Tiles of zoom 22 are 9.6 m wide at the equator; four of them meet at its zero meridian. The local plane has
// its origin there: tiles are red to the north-east of it, blue to the south-west, else white.
TEST(EvalCommand, DrawsMapTilesBelowThePaths) {
  const PathFiles files;
  constexpr int kMiddle = 1 << 21;
  for (int x = kMiddle - 4; x < kMiddle + 4; ++x) {
    std::filesystem::create_directories(files.folder.path() / "22" / std::to_string(x));
    for (int y = kMiddle - 4; y < kMiddle + 4; ++y) {
      const bool is_east = x >= kMiddle;
      const bool is_north = y < kMiddle;
      const cv::Scalar color = is_east != is_north ? cv::Scalar(255, 255, 255)
                               : is_east           ? cv::Scalar(255, 0, 0)
                                                   : cv::Scalar(0, 0, 255);
      datasets::write_png(files.folder.path() / "22" / std::to_string(x) / (std::to_string(y) + ".png"),
                          cv::Mat(256, 256, CV_8UC3, color));
    }
  }
  const auto plot = [&](const std::string& name) {
    const std::filesystem::path file = files.folder.path() / name;
    const ProgramResult result =
        run_program({"eval", files.gt, files.est, "--plot", file.string(), "--figure", "path", "--map-tiles",
                     "file://" + files.folder.path().string() + "/{z}/{x}/{y}.png", "--map-crs",
                     "+proj=aeqd +lat_0=0 +lon_0=0 +datum=WGS84", "--map-credit", "tiles of this test"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return file;
  };
  const cv::Mat image = datasets::read_image(plot("plot.png"));
  // Half of the contrast of the tiles.
  const auto center_of = [&](const cv::Vec3b& color) {
    cv::Point2d sum;
    double count = 0.0;
    for (int row = 0; row < image.rows; ++row) {
      for (int column = 0; column < image.cols; ++column) {
        if (image.at<cv::Vec3b>(row, column) != color) continue;
        sum += cv::Point2d(column, row);
        ++count;
      }
    }
    EXPECT_GT(count, 1000.0);
    return sum / count;
  };
  const cv::Point2d red = center_of({255, 128, 128});
  const cv::Point2d blue = center_of({128, 128, 255});
  EXPECT_GT(red.x, blue.x + 100.0);
  EXPECT_LT(red.y, blue.y - 100.0);
  std::ifstream svg(plot("plot.svg"));
  const std::string text{std::istreambuf_iterator<char>(svg), {}};
  EXPECT_NE(text.find("<image "), std::string::npos);
  EXPECT_NE(text.find(">Map: tiles of this test</text>"), std::string::npos);
}

/// The rows of a path with other columns: nanoseconds, and a separator.
std::string nanosecond_rows(const Trajectory& path, char separator, bool w_first) {
  std::string text;
  char row[320];
  for (const auto& [pose, t] : path.poses) {
    const Eigen::Vector4d q = w_first ? Eigen::Vector4d(pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z())
                                      : Eigen::Vector4d(pose.q.coeffs());
    std::snprintf(row, sizeof row, "%lld %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                  static_cast<long long>(t.ns + 1403636579763555584), pose.p.x(), pose.p.y(), pose.p.z(),
                  q[0], q[1], q[2], q[3]);
    text += row;
  }
  std::replace(text.begin(), text.end(), ' ', separator);
  return text;
}

TEST(EvalCommand, ReadsQuaternionsInTheOrderThatIsConsistent) {
  const TemporaryFolder folder;
  const Trajectory gt = test::smooth_path(2001, 0.01);
  const Trajectory est = test::smooth_path(401, 0.05);
  for (const char separator : {' ', ','}) {
    for (const bool gt_w_first : {false, true}) {
      for (const bool est_w_first : {false, true}) {
        const auto a = folder.write("a.txt", nanosecond_rows(gt, separator, gt_w_first)).string();
        const auto b = folder.write("b.txt", nanosecond_rows(est, ' ', est_w_first)).string();
        const ProgramResult result = run_program({"eval", a, b, "--protocol", "strict:se3", "--json"});
        ASSERT_EQ(result.exit_code, 0) << result.err;
        const auto json = nlohmann::json::parse(result.out);
        EXPECT_LT(json.at("evaluations").at(0).at("ate_deg").at("rmse"), 0.1) << gt_w_first << est_w_first;
        EXPECT_NE(result.err.find("in the order q"), std::string::npos) << result.err;
      }
    }
  }
}

TEST(EvalCommand, RefusesAnOrderOfQuaternionsThatContradictsTheFormat) {
  const PathFiles files;
  for (const std::string header : {"", "# t tx ty tz qx qy qz qw\n"}) {
    const std::string swapped =
        eval::format_tum(eval::with_other_order(test::smooth_path(401, 0.05), eval::QuaternionOrder::kWxyz));
    const std::string rows = header + swapped.substr(swapped.find('\n') + 1);
    const auto wrong = files.folder.write("wrong.txt", rows).string();
    const ProgramResult result = run_program({"eval", files.gt, wrong});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.err.find("wrong.txt"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("# t tx ty tz qw qx qy qz"), std::string::npos) << result.err;
    const auto named =
        files.folder.write("named.txt", "# t tx ty tz qw qx qy qz\n" + rows.substr(header.size()));
    EXPECT_EQ(run_program({"eval", files.gt, named.string()}).exit_code, 0);
  }
}

TEST(EvalCommand, RatesTheCovariancesThatAnEstimateBrings) {
  const PathFiles files;
  // Errors of 0.2 m and claimed standard deviations of 0.1 m and 0.01 rad: NEES / 3 = 4 / 3.
  std::string columns = "# t tx ty tz qx qy qz qw\n", rows;
  const Trajectory path = test::smooth_path(401, 0.05);
  for (std::size_t i = 0; i < path.poses.size(); ++i) {
    StampedPose pose = path.poses[i];
    pose.T_w_f.p.x() += i == 0 ? 0.0 : i % 2 == 0 ? 0.2 : -0.2;
    Trajectory one;
    one.poses.push_back(pose);
    const std::string text = eval::format_tum(one);  // a header, then the pose
    const std::string row = text.substr(text.find('\n') + 1, text.size() - text.find('\n') - 2);
    const std::string variances = " 0.01 0.01 0.01 0.0001 0.0001 0.0001\n";
    columns += row + variances;
    rows += row.substr(0, row.find(' ')) + variances;
  }
  const std::string est = files.folder.write("claims.txt", columns).string();
  const std::string extra = files.folder.write("covariances.txt", rows).string();
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"eval", files.gt, est, "--json"},
        std::vector<std::string>{"eval", files.gt, est, "--json", "--covariance", extra}}) {
    const ProgramResult result = run_program(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto covariance = nlohmann::json::parse(result.out).at("covariance");
    EXPECT_EQ(covariance.at("poses"), 341);
    EXPECT_NEAR(covariance.at("position").at("nees_ratio").get<double>(), 4.0 / 3.0, 1e-3);
    EXPECT_NEAR(covariance.at("position").at("within_3_sigma").get<double>(), 1.0, 1e-9);
    EXPECT_LT(covariance.at("rotation").at("nees_ratio").get<double>(), 1e-6);
  }
  const ProgramResult table = run_program({"eval", files.gt, est});
  EXPECT_NE(table.out.find("relative to the first pose"), std::string::npos) << table.out;
  EXPECT_NE(table.err.find("6 columns after the pose are covariances"), std::string::npos) << table.err;
  EXPECT_EQ(run_program({"eval", files.gt, files.est}).out.find("NEES"), std::string::npos);
  const ProgramResult several = run_program({"eval", files.gt, est, files.est, "--covariance", extra});
  EXPECT_EQ(several.exit_code, 2);
  EXPECT_NE(several.err.find("--covariance"), std::string::npos);
}

TEST(EvalCommand, RejectsAnUnknownProtocol) {
  const PathFiles files;
  const ProgramResult result = run_program({"eval", files.gt, files.est, "--protocol", "tum"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("--protocol tum: unknown protocol; expected one of: compat:tum, "),
            std::string::npos);
}

TEST(EvalCommand, AcceptsTheFormerNameOfTheProtocolOption) {
  const PathFiles files;
  const ProgramResult result = run_program(
      {"eval", files.gt, files.est, "--recipe", "compat:evo", "--protocol", "compat:tum", "--csv"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("compat:tum"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("compat:evo"), std::string::npos) << result.out;
  EXPECT_EQ(run_program({"eval", "--help"}).out.find("--recipe"), std::string::npos);
}

/// Poses on a line whose direction is the x or the y axis, which turn about it.
std::string line_rows(bool along_x, double turn_per_pose) {
  std::string text;
  char row[160];
  for (int i = 0; i < 60; ++i) {
    std::snprintf(row, sizeof row, "%.1f %d %d 0 %.9f 0 0 %.9f\n", 0.1 * i, along_x ? i : 0, along_x ? 0 : i,
                  std::sin(0.5 * turn_per_pose * i), std::cos(0.5 * turn_per_pose * i));
    text += row;
  }
  return text;
}

TEST(EvalCommand, SaysThatAStraightLineLeavesTheRotationNotDetermined) {
  const TemporaryFolder folder;
  const std::string gt = folder.write("gt.txt", line_rows(true, 0.0)).string();
  const std::string same = folder.write("same.txt", line_rows(true, 0.001)).string();
  const ProgramResult decided = run_program({"eval", gt, same, "--json"});
  EXPECT_EQ(decided.exit_code, 0) << decided.err;
  const auto evaluations = nlohmann::json::parse(decided.out).at("evaluations");
  ASSERT_EQ(evaluations.size(), 2U);
  for (const auto& evaluation : evaluations) {
    EXPECT_EQ(evaluation.at("alignment").at("rotation"), "orientations");
    EXPECT_LT(evaluation.at("ate_deg").at("rmse"), 3.0);
    EXPECT_NE(evaluation.at("notes").dump().find("not determined"), std::string::npos);
  }
  const std::string spinning = folder.write("spinning.txt", line_rows(true, 0.5)).string();
  const std::string errors = (folder.path() / "errors.csv").string();
  const std::string turned = folder.write("turned.txt", line_rows(true, 0.01)).string();
  const ProgramResult undecided =
      run_program({"eval", turned, spinning, "--protocol", "strict:se3", "--csv", "--per-pose", errors});
  EXPECT_EQ(undecided.exit_code, 0) << undecided.err;
  EXPECT_NE(undecided.out.find("strict:se3,60,1.0000,n/a,0.000000,n/a,"), std::string::npos) << undecided.out;
  EXPECT_NE(undecided.err.find("not determined, and the orientations do not tell it"), std::string::npos);
  std::ifstream rows(errors);
  std::string row;
  std::getline(rows, row);
  std::getline(rows, row);
  EXPECT_TRUE(row.ends_with(",n/a")) << row;
}

TEST(EvalCommand, AOnePoseTrajectoryIsAFailure) {
  const PathFiles files;
  const std::string one =
      files.folder.write("one.txt", eval::format_tum(test::smooth_path(1, 0.05))).string();
  const ProgramResult alone = run_program({"eval", files.gt, one});
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_NE(alone.err.find("one.txt: has one pose: a failed run"), std::string::npos) << alone.err;
  const ProgramResult table = run_program({"eval", files.gt, one, files.est});
  EXPECT_EQ(table.exit_code, 1) << table.err;
  EXPECT_NE(table.out.find("failed  one.txt"), std::string::npos) << table.out;
  const ProgramResult text = run_program({"eval", files.gt, one, files.est, "--json"});
  const auto json = nlohmann::json::parse(text.out);
  EXPECT_EQ(json.at("runs").at(0).at("status"), "failed");
  EXPECT_TRUE(json.at("runs").at(0).at("ate_rmse_m").is_null());
  EXPECT_EQ(json.at("runs").at(1).at("status"), "ok");
  EXPECT_EQ(json.at("comparison").at("ranking").at(1).at("failed"), true);
}

TEST(EvalCommand, MarksRelativeErrorsOfFewPairs) {
  const PathFiles files;
  const std::string few =
      files.folder.write("few.txt", eval::format_tum(test::smooth_path(26, 0.05))).string();
  for (const char* style : {"--markdown", "--csv", "--json"}) {
    const ProgramResult result = run_program({"eval", files.gt, few, "--protocol", "strict:se3", style});
    const ProgramResult many = run_program({"eval", files.gt, files.est, "--protocol", "strict:se3", style});
    const std::string mark = style == std::string("--markdown") ? "\\* RPE of fewer than 10 pairs."
                             : style == std::string("--csv")    ? ",6,1 s,"
                                                                : "the RPE is that of only 6 pairs";
    EXPECT_NE(result.out.find(mark), std::string::npos) << result.out;
    EXPECT_EQ(many.out.find(mark), std::string::npos) << many.out;
  }
}

/// The document of one estimate with these options.
nlohmann::json eval_json(const std::vector<std::string>& files, std::vector<std::string> options) {
  std::vector<std::string> words = {"eval"};
  words.insert(words.end(), files.begin(), files.end());
  words.insert(words.end(), options.begin(), options.end());
  words.emplace_back("--json");
  const ProgramResult result = run_program(words);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return nlohmann::json::parse(result.out);
}

TEST(EvalCommand, TheTopLevelMetricsFollowTheProtocolAndItsOptions) {
  const TemporaryFolder folder;
  const std::string gt = folder.write("gt.txt", eval::format_tum(test::smooth_path(2001, 0.01))).string();
  Trajectory path = test::smooth_path(401, 0.05);
  for (StampedPose& pose : path.poses)
    pose.T_w_f.p = 1.5 * pose.T_w_f.p + 0.01 * std::sin(40.0 * to_seconds(pose.t)) * Eigen::Vector3d::UnitZ();
  const std::string est = folder.write("est.txt", eval::format_tum(path)).string();
  const std::vector<std::vector<std::string>> cases = {
      {"--protocol", "strict:sim3"},
      {"--protocol", "strict:none", "--rpe-delta", "2"},
      {"--align", "sim3"},
      {"--rpe-delta", "0.5"},
      {"--max-difference", "0.004"},
      {"--offset", "0.003"},
      {"--protocol", "compat:evo", "--rpe-unit", "f", "--rpe-delta", "3"},
      {"--protocol", "strict:se3", "--rpe-unit", "m", "--rpe-delta", "0.5"}};
  for (const auto& options : cases) {
    const auto json = eval_json({gt, est}, options);
    const auto& first = json.at("evaluations").at(0);
    for (const char* key : {"ate_rmse_m", "rpe_trans_rmse_m_per_s", "rpe_rot_rmse_deg_per_s"})
      EXPECT_EQ(json.at(key), first.value(key, nlohmann::json())) << key << options[1];
    EXPECT_EQ(json.at("ate_pairs"), first.at("pairs"));
    const std::string protocol = first.at("protocol");
    EXPECT_TRUE(json.at("protocols").at("ate").get<std::string>().starts_with(protocol));
    EXPECT_TRUE(json.at("protocols").at("rpe").get<std::string>().starts_with(protocol));
  }
}

TEST(EvalCommand, TheComparisonFollowsTheOptionsOrNamesThem) {
  const TemporaryFolder folder;
  const std::string gt = folder.write("gt.txt", eval::format_tum(test::smooth_path(2001, 0.01))).string();
  Trajectory path = test::smooth_path(401, 0.05);
  const std::string rigid = folder.write("rigid.txt", eval::format_tum(path)).string();
  for (StampedPose& pose : path.poses) pose.T_w_f.p *= 1.5;
  const std::string scaled = folder.write("scaled.txt", eval::format_tum(path)).string();
  const auto comparison = [&](const std::vector<std::string>& options) {
    return eval_json({gt, scaled, rigid}, options).at("comparison");
  };
  const auto by_protocol = comparison({"--protocol", "strict:sim3"});
  EXPECT_EQ(by_protocol.at("alignment"), "sim3");
  EXPECT_LT(by_protocol.at("ranking").at(1).at("common_ate_rmse_m"), 1e-5);
  EXPECT_TRUE(by_protocol.at("not_followed").empty());
  EXPECT_GT(comparison({"--protocol", "strict:se3"}).at("ranking").at(1).at("common_ate_rmse_m"), 0.05);
  EXPECT_EQ(comparison({"--max-difference", "0.5"}).at("max_difference_s"), 0.5);
  EXPECT_EQ(comparison({"--rpe-delta", "2"}).at("rpe_delta_s"), 2.0);
  EXPECT_EQ(
      comparison({"--protocol", "compat:tum", "--rpe-unit", "m", "--align-first", "50"}).at("not_followed"),
      nlohmann::json({"--rpe-delta 1 --rpe-unit m", "--align-first 50", "the association of compat:tum"}));
  const ProgramResult text = run_program({"eval", gt, scaled, rigid, "--align-first", "50"});
  EXPECT_NE(text.out.find("; not followed: --align-first 50"), std::string::npos) << text.out;
}

TEST(EvalCommand, EvaluatesEveryIntervalOfRelativeErrors) {
  const PathFiles files;
  const auto evaluations =
      eval_json({files.gt, files.est}, {"--protocol", "strict:se3", "--rpe-delta", "1", "--rpe-delta", "0.5m",
                                        "--rpe-delta", "5deg", "--protocol", "compat:tum"})
          .at("evaluations");
  ASSERT_EQ(evaluations.size(), 6U);
  const char* const units[] = {"s", "m", "deg"};
  for (std::size_t i = 0; i < evaluations.size(); ++i) {
    EXPECT_EQ(evaluations.at(i).at("rpe_unit"), units[i % 3]);
    EXPECT_GT(evaluations.at(i).at("rpe_pairs"), 10);
  }
}

TEST(EvalCommand, PrintsStatisticsOfTheErrors) {
  const PathFiles files;
  const ProgramResult result =
      run_program({"eval", files.gt, files.est, "--statistics", "--protocol", "strict:se3", "--csv"});
  EXPECT_NE(result.out.find("estimate,protocol,error,n,RMSE,mean,std,median,75 %,90 %,95 %,99 %,max"),
            std::string::npos)
      << result.out << result.err;
  EXPECT_NE(result.out.find("RPE over 1 s [deg]"), std::string::npos);
}

TEST(EvalCommand, SolvesForBodyFrameAndClock) {
  const TemporaryFolder folder;
  const auto pose_at = [](double t) {
    return Pose{exp_so3({0.4 * std::sin(1.3 * t), 0.3 * std::cos(0.9 * t), 0.5 * std::sin(0.4 * t)}),
                {2.0 * std::sin(0.5 * t), 1.5 * std::cos(0.7 * t), 0.3 * std::sin(t)}};
  };
  const Pose T_f_g{exp_so3({0.0, 0.0, 0.7}), {0.1, 0.0, -0.2}};
  Trajectory gt;
  Trajectory est;
  for (int i = 0; i <= 2000; ++i)
    gt.poses.emplace_back(from_seconds(0.01 * i + 0.05), pose_at(0.01 * i) * T_f_g);
  for (int i = 20; i < 380; ++i) est.poses.emplace_back(from_seconds(0.05 * i), pose_at(0.05 * i));
  const std::string truth = folder.write("gt.txt", eval::format_tum(gt)).string();
  const std::string estimate = folder.write("est.txt", eval::format_tum(est)).string();
  const auto json = eval_json({truth, estimate}, {"--align", "hand-eye"});
  EXPECT_NEAR(json.at("hand_eye").at("offset_s").get<double>(), 0.05, 1e-3);
  EXPECT_NEAR(json.at("hand_eye").at("body_translation_m").at(2).get<double>(), -0.2, 1e-3);
  EXPECT_LT(json.at("ate_rmse_m"), 1e-3);
  EXPECT_GT(eval_json({truth, estimate}, {"--align", "se3"}).at("ate_rmse_m"), 0.02);
  EXPECT_EQ(eval_json({truth, estimate}, {"--align", "posyaw"}).at("ate_rmse_m"),
            eval_json({truth, estimate}, {"--align", "yaw"}).at("ate_rmse_m"));
}

TEST(EvalCommand, AnOffsetThatIsAppliedIsNoWarning) {
  const PathFiles files;
  const std::string late =
      files.folder.write("late.txt", eval::format_tum(test::smooth_path(401, 0.05))).string();
  Trajectory path = test::smooth_path(401, 0.05);
  for (StampedPose& pose : path.poses) pose.t = after(pose.t, 0.3);
  files.folder.write("late.txt", eval::format_tum(path));
  EXPECT_NE(run_program({"eval", files.gt, late}).err.find("time offset of -0.3"), std::string::npos);
  EXPECT_EQ(run_program({"eval", files.gt, late, "--offset", "-0.3"}).err.find("time offset of"),
            std::string::npos);
}

TEST(EvalCommand, AnOffsetThatIsFoundLeavesTablesForProgramsValid) {
  const PathFiles files;
  Trajectory path = test::smooth_path(401, 0.05);
  for (StampedPose& pose : path.poses) pose.t = after(pose.t, 0.3);
  const std::string late = files.folder.write("late.txt", eval::format_tum(path)).string();
  const nlohmann::json json = eval_json({files.gt, late}, {"--find-offset"});
  EXPECT_NEAR(json.at("time_offset").at("offset_s"), -0.3, 0.01);
  EXPECT_GT(json.at("time_offset").at("ate_rmse_m_without_offset"), json.at("time_offset").at("ate_rmse_m"));
  EXPECT_NE(run_program({"eval", files.gt, late, "--find-offset"}).out.find("offset -0.3"),
            std::string::npos);
  const ProgramResult csv = run_program({"eval", files.gt, late, "--find-offset", "--csv"});
  EXPECT_EQ(csv.out.find("offset"), std::string::npos) << csv.out;
  EXPECT_NE(csv.err.find("late.txt: offset -0.3"), std::string::npos) << csv.err;
}

TEST(EvalOpenlorisCommand, PrintsTheSceneTableAndDrawsTheFigure) {
  const TemporaryFolder folder;
  const eval::OpenlorisFile truth{
      .scene = "cafe", .frame = "base_link", .sequences = {{1, test::smooth_path(2001, 0.01)}}};
  const eval::OpenlorisFile result{
      .scene = "cafe", .frame = "base_link", .sequences = {{1, test::smooth_path(201, 0.05)}}};
  folder.write("truth/gt_cafe_1.txt", eval::format_openloris(truth));
  folder.write("results/mine/cafe-1-1.txt", eval::format_openloris(result));
  const std::string figure = (folder.path() / "figure").string();
  const ProgramResult run =
      run_program({"eval", "openloris", (folder.path() / "results").string(), "--ground-truth",
                   (folder.path() / "truth").string(), "--csv", "--figure", figure});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // 10 s of poses, and the last pose counts for 1 s more, of 20 s.
  EXPECT_NE(run.out.find("\nmine,cafe,1/1,55.0,55.0,0.0000,0.0000,0.0000,0.000,"), std::string::npos)
      << run.out;
  EXPECT_TRUE(std::filesystem::exists(figure + ".svg"));
  EXPECT_TRUE(std::filesystem::exists(figure + ".png"));
}

TEST(EvalOpenlorisCommand, RejectsAFolderWithoutGroundTruth) {
  const TemporaryFolder folder;
  const ProgramResult run =
      run_program({"eval", "openloris", folder.path().string(), "--ground-truth", folder.path().string()});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("no gt_<scene>_1.txt found"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace stillpoint
