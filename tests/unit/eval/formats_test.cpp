// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "eval/io/matrix_files.h"
#include "eval/io/openloris_file.h"
#include "eval/io/trajectory_file.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/simulated/smooth_path.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::eval {
namespace {

void expect_same(const Trajectory& a, const Trajectory& b) {
  ASSERT_EQ(a.poses.size(), b.poses.size());
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    EXPECT_EQ(a.poses[i].t, b.poses[i].t);
    EXPECT_LT((a.poses[i].T_w_f.p - b.poses[i].T_w_f.p).norm(), 2e-9);  // 9 decimals per coordinate
    EXPECT_LT(a.poses[i].T_w_f.q.angularDistance(b.poses[i].T_w_f.q), 1e-7);
  }
}

const Trajectory kPath = test::smooth_path(20, 0.1, 1403636579.763555584);

TEST(Formats, AreReadBackAsWritten) {
  expect_same(parse_tum(format_tum(kPath), "a").trajectory, kPath);
  expect_same(parse_euroc(format_euroc(kPath), "a").trajectory, kPath);
  const KittiTexts kitti = format_kitti(kPath);
  expect_same(parse_kitti(kitti.poses, "a", kitti.times, "b").trajectory, kPath);
  const OpenlorisFile file{.scene = "home", .frame = "d400_color", .sequences = {{3, kPath}}};
  expect_same(parse_openloris(format_openloris(file), "a").sequences.at(3), kPath);
}

TEST(Formats, SkipAByteOrderMarkAndNameUtf16) {
  const TemporaryFolder folder;
  const auto marked = folder.write("marked.tum", "\xEF\xBB\xBF" + format_tum(kPath));
  expect_same(read_trajectory({.path = marked}).trajectory, kPath);
  const auto wide = folder.write("wide.tum", std::string("\xFF\xFE"
                                                         "1\0",
                                                         4));
  expect_input_error([&] { static_cast<void>(read_trajectory({.path = wide})); },
                     {"wide.tum: is UTF-16 text"});
}

TEST(Formats, ABagNeedsTheTopicOfThePoses) {
  const TemporaryFolder folder;
  folder.write("ros2/metadata.yaml", "");
  folder.write("ros2/a_0.db3", "");
  for (const auto& bag : {folder.write("a.bag", ""), folder.write("a.mcap", ""), folder.path() / "ros2"}) {
    expect_input_error([&] { static_cast<void>(read_trajectory({.path = bag})); },
                       {bag.string() + ": is a bag", "name the topic", bag.string() + ":/ground_truth"});
  }
}

TEST(Formats, SevenScenesFolderIsReadBackAsWritten) {
  Trajectory path;  // stamps at 30 Hz, which the format implies
  for (int i = 0; i < 5; ++i) {
    path.poses.push_back({Timestamp{(i * 1'000'000'000LL + 15) / 30}, test::smooth_pose(i)});
  }
  const TemporaryFolder folder;
  write_seven_scenes(path, folder.path());
  expect_same(read_trajectory({.path = folder.path()}).trajectory, path);
}

TEST(Formats, AreDetectedFromTheContent) {
  EXPECT_EQ(detect_format(format_tum(kPath)), TrajectoryFormat::kTum);
  EXPECT_EQ(detect_format(format_euroc(kPath)), TrajectoryFormat::kEuroc);
  EXPECT_EQ(detect_format(format_kitti(kPath).poses), TrajectoryFormat::kKitti);
  EXPECT_EQ(detect_format("scene: home\nseq: 1\n"), TrajectoryFormat::kOpenloris);
}

TEST(Openloris, DropsRepeatedPosesUnlessTheyAreRequested) {
  const std::string text =
      "scene:Home\nframe: d400_imu\nseq: 1\n1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n3 nan 0 0 0 0 0 1\n"
      "4 9.5 1 0 0 0 0 0 1\nseq: 2\n1 1 0 0 0 0 0 1\n2 2 0 0 0 0 0 1\n";
  const OpenlorisFile dropped = parse_openloris(text, "a");
  EXPECT_EQ(dropped.scene, "home");
  EXPECT_EQ(dropped.frame, "d400_imu");
  // Sequence 1: the row at 2 s repeats the pose, the one at 3 s has NaN, the one at 4 s has nine columns, the
  // last seven of which are its pose. The first pose of sequence 2 equals that pose and is dropped, too.
  EXPECT_EQ(dropped.sequences.at(1).poses.size(), 2u);
  EXPECT_EQ(dropped.sequences.at(2).poses.size(), 1u);
  EXPECT_EQ(dropped.repeated_poses, 2u);
  EXPECT_EQ(dropped.repairs.skipped, 1u);
  EXPECT_EQ(parse_openloris(text, "a", RepeatedPoses::kKeep).sequences.at(2).poses.size(), 2u);
}

TEST(Openloris, CountsRepeatedStampsOverAllSequences) {
  const OpenlorisFile file = parse_openloris(
      "seq: 1\n1 0 0 0 0 0 0 1\n1 5 0 0 0 0 0 1\nseq: 2\n2 1 0 0 0 0 0 1\n1.9 2 0 0 0 0 0 1\n", "a");
  EXPECT_EQ(file.sequences.at(1).poses.size(), 1u);
  EXPECT_EQ(file.sequences.at(2).poses.size(), 2u);
  EXPECT_EQ(file.repairs.repeated, 1u);
  EXPECT_EQ(file.repairs.reordered, 1u);
}

TEST(Formats, ReportTheLineOfAMalformedRow) {
  expect_input_error([] { static_cast<void>(parse_euroc("1.5,0,0,0,1,0,0,0\n", "a.csv")); },
                     {"a.csv:1", "nanoseconds"});
  expect_input_error([] { static_cast<void>(parse_kitti("1 0 0 0 0 1 0 0 0 0 2 0\n", "p", "0\n", "t")); },
                     {"p:1", "not a rotation"});
  expect_input_error([] { static_cast<void>(parse_kitti("1 0 0 0 0 1 0 0 0 0 1 0\n", "p", "0\n1\n", "t")); },
                     {"t", "more times"});
  expect_input_error([] { static_cast<void>(parse_openloris("1 0 0 0 0 0 0 1\n", "o")); }, {"o:1", "seq"});
  expect_input_error([] { static_cast<void>(parse_openloris("seq: 1\nseq: 1\n", "o")); },
                     {"o:2", "duplicate"});
  expect_input_error([] { static_cast<void>(read_trajectory({.path = "/none"})); }, {"/none", "opened"});
}

}  // namespace
}  // namespace stillpoint::eval
