// SPDX-License-Identifier: BSD-3-Clause
#include "eval/io/trajectory_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/base/error.h"
#include "eval/io/text_reader.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::eval {
namespace {

std::string message_of(std::string_view text) {
  try {
    static_cast<void>(parse_tum(text, "a.txt"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ParseStamp, IsExactToTheNanosecond) {
  // As a double, 1560000000.123456789 would be off by up to 120 ns.
  EXPECT_EQ(parse_stamp("1560000000.123456789")->ns, 1560000000123456789);
  EXPECT_EQ(parse_stamp("1700000000.00130010")->ns, 1700000000001300100);
  EXPECT_EQ(parse_stamp(".5")->ns, 500000000);
  EXPECT_EQ(parse_stamp("25e-1")->ns, 2500000000);
  EXPECT_EQ(parse_stamp("0")->ns, 0);
  EXPECT_EQ(parse_stamp("1305031098.6659")->ns, 1305031098665900000);
  EXPECT_EQ(parse_stamp("0.000000001")->ns, 1);
  EXPECT_EQ(parse_stamp("-1.5")->ns, -1500000000);
  EXPECT_EQ(parse_stamp("1.3050310986659e+09")->ns, 1305031098665900000);
  EXPECT_EQ(parse_stamp("5")->ns, 5000000000);
}

TEST(ParseStamp, RoundsBeyondNineDecimals) {
  EXPECT_EQ(parse_stamp("1.0000000014999")->ns, 1000000001);
  EXPECT_EQ(parse_stamp("1.0000000015")->ns, 1000000002);
  EXPECT_EQ(parse_stamp("5e-10")->ns, 1);
  EXPECT_EQ(parse_stamp("4e-10")->ns, 0);
}

TEST(ParseStamp, RejectsMalformedStamps) {
  for (const char* text : {"", "-", ".", "nan", "inf", "1.2.3", "1e", "1e999", "12a", "1 2", "9300000000",
                           "1305031098665900000"}) {
    EXPECT_FALSE(parse_stamp(text)) << text;
  }
}

TEST(FormatStamp, IsTheInverseOfParsing) {
  for (const char* text : {"1305031098.665900000", "-1.500000000", "-0.000000001", "0.000000000"}) {
    EXPECT_EQ(format_stamp(*parse_stamp(text)), text);
  }
}

TEST(ParseTum, ReadsRowsAndSkipsComments) {
  const auto loaded = parse_tum("# a comment\r\n\n1.5,1\t2 3 0 0 0 1.05 extra\n", "a.txt", "camera");
  ASSERT_EQ(loaded.trajectory.poses.size(), 1u);
  const StampedPose& pose = loaded.trajectory.poses[0];
  EXPECT_EQ(loaded.trajectory.frame, "camera");
  EXPECT_EQ(pose.t.ns, 1500000000);
  EXPECT_EQ(pose.T_w_f.p, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(pose.T_w_f.q.w(), 1.0);  // normalized from 1.05
}

TEST(ParseTum, CountsRowsWithoutAPose) {
  const auto loaded = parse_tum("1 0 0 0 0 0 0 0\n2 nan 0 0 0 0 0 1\n3 0 0 0 0 0 0 1\n", "a.txt");
  EXPECT_EQ(loaded.repairs.skipped, 2u);
  EXPECT_EQ(loaded.trajectory.poses.size(), 1u);
}

TEST(ParseTum, ReportsTheLineOfAMalformedRow) {
  const std::string good = "1 0 0 0 0 0 0 1\n";
  EXPECT_EQ(message_of(good + "2 0 0 0 0 0 1\n"),
            "a.txt:2: a pose needs 8 numbers, found 7; expected \"t tx ty tz qx qy qz qw\"");
  EXPECT_EQ(message_of(good + "2 0 x 0 0 0 0 1\n"), "a.txt:2: \"x\" is not a number");
  EXPECT_EQ(message_of("1403636579763555584 0 0 0 0 0 0 1\n"),
            "a.txt:1: stamp \"1403636579763555584\" exceeds 292 years; is it in nanoseconds? convert it to "
            "seconds");
  EXPECT_EQ(message_of("# nothing\n"), "a.txt: no poses found; expected rows \"t tx ty tz qx qy qz qw\"");
}

TEST(ParseTum, UsesTheFirstOfRowsWithTheSameStampAndCountsTheOthers) {
  const auto loaded = parse_tum(
      "1 10 0 0 0 0 0 1\n2 20 0 0 0 0 0 1\n2 21 0 0 0 0 0 1\n2 22 0 0 0 0 0 1\n3 30 0 0 0 0 0 1\n", "a.txt");
  ASSERT_EQ(loaded.trajectory.poses.size(), 3u);
  EXPECT_EQ(loaded.trajectory.poses[1].T_w_f.p.x(), 20.0);
  EXPECT_EQ(loaded.repairs.repeated, 2u);
  EXPECT_EQ(loaded.repairs.reordered, 0u);
}

TEST(ParseTum, SortsRowsThatAreUpToOneSecondOutOfOrder) {
  const auto loaded = parse_tum(
      "1 1 0 0 0 0 0 1\n1.2 3 0 0 0 0 0 1\n1.1 2 0 0 0 0 0 1\n2.1 4 0 0 0 0 0 1\n1.1 9 0 0 0 0 0 1\n",
      "a.txt");
  ASSERT_EQ(loaded.trajectory.poses.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(loaded.trajectory.poses[i].T_w_f.p.x(), static_cast<double>(i + 1));
  EXPECT_EQ(loaded.repairs.reordered, 1u);
  EXPECT_EQ(loaded.repairs.repeated, 1u);  // the last row, exactly 1 s before the latest pose
}

TEST(ParseTum, RejectsRowsThatAreFurtherOutOfOrder) {
  EXPECT_EQ(message_of("1 0 0 0 0 0 0 1\n3 0 0 0 0 0 0 1\n1.5 0 0 0 0 0 0 1\n"),
            "a.txt:3: stamp 1.500000000 s is 1.500000 s earlier than a row before; sort the file by time, or "
            "split it if it contains several runs");
}

/// Ten rows whose stamps are whole numbers.
std::string rows_apart(long long interval) {
  std::string text;
  for (int i = 0; i < 10; ++i) text += std::to_string(i * interval) + " 0 0 0 0 0 0 1\n";
  return text;
}

TEST(ParseTum, StampsThatAreHoursApartAreInAnotherUnit) {
  EXPECT_NE(message_of(rows_apart(50'000'000))
                .find("a.txt: as seconds, the stamps are 5e+07 s apart: they "
                      "seem to be in nanoseconds"),
            std::string::npos);
  EXPECT_NE(message_of(rows_apart(50'000)).find("seem to be in microseconds;"), std::string::npos);
  EXPECT_NE(message_of(rows_apart(1'000'000)).find("in microseconds or nanoseconds"), std::string::npos);
  EXPECT_EQ(message_of(rows_apart(3600)), "no error");
  EXPECT_EQ(message_of("0 0 0 0 0 0 0 1\n1500000000 0 0 0 0 0 0 1\n1500000001 0 0 0 0 0 0 1\n"),
            "no error");  // a first pose without a stamp
}

TEST(ParseTum, StampsThatLostTheirDigitsAreAnError) {
  std::string rows;
  for (int i = 0; i < 6; ++i) rows += "1.30503e+09 " + std::to_string(i) + " 0 0 0 0 0 1\n";
  EXPECT_NE(message_of(rows).find("a.txt: 6 rows have 1 stamp (1305030000.000000000 s); if they lost digits"),
            std::string::npos);
  EXPECT_EQ(message_of(rows + "1.30504e+09 0 0 0 0 0 0 1\n"), "no error");  // 3.5 rows per stamp
}

TEST(RepairTexts, NameEachKindOfRepairedRow) {
  EXPECT_TRUE(repair_texts({}).empty());
  const std::vector<std::string> texts = repair_texts({.skipped = 1, .repeated = 2, .reordered = 3});
  ASSERT_EQ(texts.size(), 3u);
  EXPECT_EQ(texts[0], "1 row skipped: no valid pose (NaN or a zero quaternion)");
  EXPECT_NE(texts[1].find("2 rows skipped: the time stamp repeats"), std::string::npos);
  EXPECT_NE(texts[2].find("3 rows sorted by time"), std::string::npos);
}

TEST(ReadTumGroundTruth, RejectsRowsThatAnEstimateMaySkip) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    return [&folder, text] {
      FaultLog strict;
      static_cast<void>(read_tum_ground_truth(folder.write("gt.txt", text), "camera", strict));
    };
  };
  expect_input_error(read("1 nan 0 0 0 0 0 1\n"), {"gt.txt:1", "\"nan\" is not finite"});
  expect_input_error(read("1 0 0 0 0 0 0 0\n"), {"gt.txt:1", "quaternion has norm 0"});
  expect_input_error(read("1 0 0 0 0 0 0 1.02\n"), {"gt.txt:1", "expected 1"});
  expect_input_error(read("# nothing\n"), {"gt.txt", "no poses found"});
}

TEST(ReadTumGroundTruth, ACollectingLogSkipsFaultyRowsOnly) {
  const TemporaryFolder folder;
  FaultLog faults(FaultLog::Mode::kCollect);
  const Trajectory truth =
      read_tum_ground_truth(
          folder.write("gt.txt", "5 0 0 0 0 0 0 1\n6 inf 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n7 0 0 0 0 0 0 1\n"),
          "camera", faults)
          .trajectory;
  EXPECT_EQ(truth.frame, "camera");
  EXPECT_EQ(truth.poses.size(), 2u);
  ASSERT_EQ(faults.messages().size(), 2u);
  EXPECT_NE(faults.messages()[0].find("gt.txt:2"), std::string::npos);
  EXPECT_NE(faults.messages()[1].find("gt.txt:3"), std::string::npos);
}

TEST(ReadEurocGroundTruth, ReadsNanosecondsAndTheScalarPartFirst) {
  const TemporaryFolder folder;
  FaultLog strict;
  const Trajectory truth =
      read_euroc_ground_truth(folder.write("data.csv", "#t\n5,1,2,3,0,1,0,0,9,9\n"), "body", strict)
          .trajectory;
  ASSERT_EQ(truth.poses.size(), 1u);
  EXPECT_EQ(truth.poses[0].t.ns, 5);
  EXPECT_EQ(truth.poses[0].T_w_f.q.x(), 1.0);
}

TEST(WriteTum, WritesNineDecimalsThatAreReadBackUnchanged) {
  const std::string text =
      "# timestamp tx ty tz qx qy qz qw\n"
      "1305031098.665900000 1.250000000 -2.500000000 0.000000000 0.000000000 0.000000000 0.600000000 "
      "0.800000000\n";
  EXPECT_EQ(format_tum(parse_tum(text, "a.txt").trajectory), text);
  const auto file = std::filesystem::path(testing::TempDir()) / "stillpoint_write_tum.txt";
  write_tum(parse_tum(text, "a.txt").trajectory, file);
  EXPECT_EQ(read_text_file(file), text);
  std::filesystem::remove(file);
}

TEST(WriteTum, ThrowsIfTheFileCannotBeWritten) {
  EXPECT_THROW(write_tum({}, "/no/such/folder/a.txt"), InputError);
}

/// Rows at 100 Hz with a position that tells the row.
std::string many_rows(int count) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += format_stamp({i * 10'000'000LL}) + " " + std::to_string(i) + " 0 0 0 0 0 1\n";
  return text;
}

TEST(ReadTum, AFileOfSeveralBlocksIsReadAsTheText) {
  // Blocks have 1 MB; the comment alone is longer than one, and a row crosses each border.
  const TemporaryFolder folder;
  const std::string text =
      "# " + std::string(3 << 20, 'x') + "\n# t tx ty tz qx qy qz qw\n" + many_rows(100000);
  const LoadedTrajectory read = read_tum(folder.write("long.txt", text));
  const LoadedTrajectory parsed = parse_tum(text, "long.txt");
  ASSERT_EQ(read.trajectory.poses.size(), 100000U);
  EXPECT_EQ(read.order_source, OrderSource::kNamed);
  for (std::size_t i = 0; i < 100000; ++i) {
    ASSERT_EQ(read.trajectory.poses[i].t, parsed.trajectory.poses[i].t);
    ASSERT_EQ(read.trajectory.poses[i].T_w_f.p.x(), static_cast<double>(i));
  }
}

TEST(ReadTum, AnErrorInALaterBlockNamesItsLine) {
  const TemporaryFolder folder;
  const std::string file = folder.write("long.txt", many_rows(100000) + "1000.5 1 0 0 0 0 zero 1\n");
  expect_input_error([&] { static_cast<void>(read_tum(file)); },
                     {"long.txt:100001", "\"zero\" is not a number"});
}

TEST(ReadTum, ALineLongerThanABlockAndNoLineFeedAtTheEndAreRead) {
  const TemporaryFolder folder;
  const std::string file =
      folder.write("wide.txt", "1 2 3 4 0 0 0 1 " + std::string(3 << 20, '7') + "\n2 2 3 4 0 0 0 1");
  EXPECT_EQ(read_tum(file).trajectory.poses.size(), 2U);
}

TEST(ParseTum, AUnitOfPositionsOtherThanMetersIsAnError) {
  EXPECT_NE(
      message_of("t [s],x [mm],y [mm],z [mm],qx,qy,qz,qw\n1,2,3,4,0,0,0,1\n").find("the positions are in mm"),
      std::string::npos);
  EXPECT_EQ(message_of("t [s],x [m],y [m],z [m],qx,qy,qz,qw\n1,2,3,4,0,0,0,1\n"), "no error");
}

TEST(ParseTum, EulerAnglesAreAnError) {
  // As a quaternion, (0, 0, 0.01, 1) would have norm 1.
  for (const char* const header : {"# t x y z roll pitch yaw status\n", "t,x,y,z,roll,pitch,yaw,status\n"}) {
    expect_input_error(
        [&] { static_cast<void>(parse_tum(std::string(header) + "1 1 2 3 0 0 0.01 1\n", "a")); },
        {"a:1", "roll, pitch and yaw", "quaternions"});
  }
}

TEST(ParseTum, AnglesBesideAQuaternionAreIgnored) {
  const LoadedTrajectory loaded = parse_tum(
      "__time,/odom/position/x,/odom/position/y,/odom/position/z,/odom/orientation/pitch,"
      "/odom/orientation/roll,/odom/orientation/w,/odom/orientation/x,/odom/orientation/y,"
      "/odom/orientation/yaw,/odom/orientation/z\n1,2,3,4,9,9,0,1,0,9,0\n",
      "a");
  EXPECT_EQ(loaded.trajectory.poses[0].T_w_f.q.x(), 1.0);
  EXPECT_EQ(loaded.trajectory.poses[0].T_w_f.p.z(), 4.0);
}

TEST(ParseTum, LinesThatEndWithCarriageReturnsOnlyAreAnError) {
  EXPECT_NE(
      message_of("1 2 3 4 0 0 0 1\r2 2 3 4 0 0 0 1\r").find("a.txt:1: lines end with carriage returns only"),
      std::string::npos);
  EXPECT_EQ(message_of("1 2 3 4 0 0 0 1\r\r\n2 2 3 4 0 0 0 1\r\n"), "no error");
}

}  // namespace
}  // namespace stillpoint::eval
