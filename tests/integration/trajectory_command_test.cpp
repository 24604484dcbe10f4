// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"
#include "tests/support/program.h"
#include "tests/support/simulated/smooth_path.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint {
namespace {

/// A file of 401 poses at 20 Hz, and the program that changes it.
struct TrajectoryFiles {
  TemporaryFolder folder;
  Trajectory path = test::smooth_path(401, 0.05);
  std::string file = folder.write("path.tum", eval::format_tum(path)).string();

  [[nodiscard]] std::string at(const std::string& name) const { return (folder.path() / name).string(); }
  static ProgramResult run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "trajectory");
    return run_program(arguments);
  }
};

void expect_same(const Trajectory& a, const Trajectory& b) {
  ASSERT_EQ(a.poses.size(), b.poses.size());
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    EXPECT_EQ(a.poses[i].t, b.poses[i].t);
    EXPECT_LT((a.poses[i].T_w_f.p - b.poses[i].T_w_f.p).norm(), 1e-8);
    EXPECT_LT(a.poses[i].T_w_f.q.angularDistance(b.poses[i].T_w_f.q), 1e-7);
  }
}

TEST(TrajectoryCommand, ConvertsToEveryFormatAndBack) {
  const TrajectoryFiles files;
  struct Conversion {
    const char* out;
    const char* to;
    std::vector<std::string> reading;
  };
  const Conversion conversions[] = {{"p.csv", "csv", {}},
                                    {"e.csv", "euroc", {}},
                                    {"k.txt", "kitti", {"--times", files.at("k_times.txt")}},
                                    {"b.bag:/odom", "bag", {}},
                                    {"m.mcap:/odom", "bag", {}},
                                    {"o.bag:/odom", "odometry", {}},
                                    {"o.mcap:/odom", "odometry", {}}};
  for (const auto& [out, to, reading] : conversions) {
    const ProgramResult there =
        TrajectoryFiles::run({"convert", files.file, "--out", files.at(out), "--to", to});
    ASSERT_EQ(there.exit_code, 0) << to << there.err;
    const std::string back = files.at(std::string(to) + ".back");
    std::vector<std::string> arguments{"convert", files.at(out), "--out", back, "--force"};
    arguments.insert(arguments.end(), reading.begin(), reading.end());
    const ProgramResult here = TrajectoryFiles::run(arguments);
    ASSERT_EQ(here.exit_code, 0) << to << here.err;
    expect_same(eval::read_tum(back).trajectory, files.path);
  }
}

TEST(TrajectoryCommand, KeepsCovariancesInTheFormatsThatHaveThem) {
  const TrajectoryFiles files;
  std::string rows;
  const std::string text = eval::format_tum(files.path);
  eval::LineReader poses(text);
  static_cast<void>(poses.next());  // the header
  while (const auto line = poses.next()) rows.append(*line).append(" 0.01 0.02 0.03 0.001 0.002 0.003\n");
  const std::string with = files.folder.write("with.tum", rows).string();
  const std::pair<const char*, const char*> outputs[] = {
      {"c.csv", "csv"}, {"c.mcap:/odom", "bag"}, {"o.mcap:/odom", "odometry"}, {"o.bag:/odom", "odometry"}};
  for (const auto& [out, to] : outputs) {
    ASSERT_EQ(TrajectoryFiles::run({"convert", with, "--out", files.at(out), "--to", to}).exit_code, 0);
    const std::string file = files.at(out);
    const std::string content = eval::read_text_file(file.substr(0, file.find(":/")));
    EXPECT_EQ(content.find("Odometry") != std::string::npos, std::string(to) == "odometry") << out;
    const std::string back = files.at("back.tum");
    const ProgramResult result = TrajectoryFiles::run({"convert", files.at(out), "--out", back, "--force"});
    EXPECT_NE(result.out.find("with covariances"), std::string::npos) << out << result.out << result.err;
    EXPECT_NE(
        eval::read_text_file(back).find(" 0.01 0 0 0 0 0 0.02 0 0 0 0 0.03 0 0 0 0.001 0 0 0.002 0 0.003\n"),
        std::string::npos)
        << out;
  }
  const ProgramResult euroc =
      TrajectoryFiles::run({"convert", with, "--out", files.at("e.csv"), "--to", "euroc"});
  EXPECT_NE(euroc.err.find("has no covariances"), std::string::npos) << euroc.err;
}

TEST(TrajectoryCommand, PartsMergeToTheWhole) {
  const TrajectoryFiles files;
  ASSERT_EQ(TrajectoryFiles::run({"crop", files.file, "--end", "7", "--out", files.at("a.tum")}).exit_code,
            0);
  ASSERT_EQ(
      TrajectoryFiles::run({"crop", files.file, "--start", "7.05", "--out", files.at("b.tum")}).exit_code, 0);
  const ProgramResult all =
      TrajectoryFiles::run({"merge", files.at("b.tum"), files.at("a.tum"), "--out", files.at("all.tum")});
  ASSERT_EQ(all.exit_code, 0) << all.err;
  expect_same(eval::read_tum(files.at("all.tum")).trajectory, files.path);
}

TEST(TrajectoryCommand, AlignmentUndoesATransform) {
  const TrajectoryFiles files;
  const ProgramResult moved = TrajectoryFiles::run({"transform", files.file, "--world", "1,-2,3,0,0,0.6,0.8",
                                                    "--scale", "2", "--out", files.at("moved.tum")});
  ASSERT_EQ(moved.exit_code, 0) << moved.err;
  const ProgramResult back =
      TrajectoryFiles::run({"transform", files.at("moved.tum"), "--align-to", files.file, "--alignment",
                            "sim3", "--out", files.at("back.tum")});
  ASSERT_EQ(back.exit_code, 0) << back.err;
  EXPECT_NE(back.out.find("scale 0.5"), std::string::npos) << back.out;
  expect_same(eval::read_tum(files.at("back.tum")).trajectory, files.path);
}

TEST(TrajectoryCommand, ResamplesAtARateAndAtTheStampsOfAnother) {
  const TrajectoryFiles files;
  ASSERT_EQ(
      TrajectoryFiles::run({"resample", files.file, "--rate", "10", "--out", files.at("slow.tum")}).exit_code,
      0);
  EXPECT_EQ(eval::read_tum(files.at("slow.tum")).trajectory.poses.size(), 201U);  // 20 s
  ASSERT_EQ(TrajectoryFiles::run(
                {"resample", files.file, "--at", files.at("slow.tum"), "--out", files.at("at.tum")})
                .exit_code,
            0);
  expect_same(eval::read_tum(files.at("at.tum")).trajectory, eval::read_tum(files.at("slow.tum")).trajectory);
}

}  // namespace
}  // namespace stillpoint
