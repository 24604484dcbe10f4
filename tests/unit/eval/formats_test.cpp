// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "eval/io/matrix_files.h"
#include "eval/io/openloris_file.h"
#include "eval/io/text_reader.h"
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

TEST(Formats, NameWhatIsNoTrajectory) {
  const TemporaryFolder folder;
  const std::string wide_text("1\0.\0\x35\0\n\0", 8);
  const std::vector<std::tuple<const char*, std::string, const char*>> files = {
      {"a.gz", "\x1F\x8B\x08", "a.gz: is compressed; decompress it, e.g. with `gunzip`"},
      {"a.xlsx", "PK\x03\x04", "a.xlsx: is compressed"},
      {"wide.txt", wide_text, "wide.txt: contains NUL bytes"},
      {"text.csv", "a sentence: no poses\n", "is it a trajectory?"},
      {"ms.txt", "1700000000000 0 0 0 0 0 0 1\n", "is it in milliseconds? convert it to seconds"},
      {"us.txt", "170000000000000 0 0 0 0 0 0 1\n", "is it in microseconds? convert it to seconds"},
      {"quoted.txt", "\"1.5\" 0 0 0 0 0 0 1\n", "is in quotation marks; remove them"},
      {"matrix13.txt", "1.5 1 0 0 .1 0 1 0 .2 0 0 1 .3\n", "has 13 numbers, which are a matrix"},
      {"matrix16.txt", "1 0 0 .1 0 1 0 .01 0 0 1 .3 0 0 0 1\n", "has 16 numbers, which are a matrix"},
      {"matrix17.txt", "1.5 1 0 0 .1 0 1 0 .2 0 0 1 .3 0 0 0 1\n", "has 17 numbers, which are a matrix"}};
  for (const auto& [name, text, problem] : files) {
    const auto file = folder.write(name, text);
    expect_input_error([&] { static_cast<void>(read_trajectory({.path = file})); }, {problem});
  }
}

TEST(Formats, OnlyTheStartOfAFileTellsThatItIsCompressed) {
  const std::string text = "BZh0 1 2\n";
  expect_input_error([&] { static_cast<void>(RowReader(text, "a").next()); }, {"a:1: is compressed"});
  RowReader rows("name 1 2\nBZh0 3 4\n", "a");
  ASSERT_TRUE(rows.next());
  EXPECT_EQ(rows.next()->text(0), "BZh0");
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

TEST(Formats, SevenScenesFilesThatAreNumberedByTimesAreErrors) {
  const TemporaryFolder folder;
  folder.write("frame-1700000000050000000.pose.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  expect_input_error([&] { static_cast<void>(read_seven_scenes(folder.path())); },
                     {"frame-1700000000050000000.pose.txt", "too large for that of a frame"});
}

TEST(Formats, AreDetectedFromTheContent) {
  EXPECT_EQ(detect_format(format_tum(kPath)), TrajectoryFormat::kTum);
  EXPECT_EQ(detect_format(format_euroc(kPath)), TrajectoryFormat::kEuroc);
  EXPECT_EQ(detect_format(format_kitti(kPath).poses), TrajectoryFormat::kKitti);
  EXPECT_EQ(detect_format("scene: home\nseq: 1\n"), TrajectoryFormat::kOpenloris);
  EXPECT_EQ(detect_format("1305031100.5 1 2 3 0.6 0 0 0.8 0.1 0.2 0.3 1\n"), TrajectoryFormat::kTum);
  EXPECT_EQ(detect_format("1 0 0 0 0 1 0 0.01 0 0 1 0\n"), TrajectoryFormat::kKitti);    // 0 1 0 0.01: norm 1
  EXPECT_EQ(detect_format("1.1 0 0 0 0 1 0 0.01 0 0 1 0\n"), TrajectoryFormat::kKitti);  // no rotation
}

/// The columns of `kPath` under the names of a header; "-" becomes a further column.
std::string named_columns(const std::string& header, const std::vector<std::string>& columns,
                          bool nanoseconds) {
  std::string text = header + "\n";
  for (const auto& [pose, t] : kPath.poses) {
    const std::map<std::string, double> values{{"x", pose.p.x()},  {"y", pose.p.y()},  {"z", pose.p.z()},
                                               {"qx", pose.q.x()}, {"qy", pose.q.y()}, {"qz", pose.q.z()},
                                               {"qw", pose.q.w()}, {"-", 7.5}};
    for (const std::string& column : columns) {
      const std::string stamp = nanoseconds ? std::to_string(t.ns) : format_stamp(t);
      char number[32];
      if (column != "t") std::snprintf(number, sizeof number, "%.9f", values.at(column));
      text += (column == "t" ? stamp : number) + std::string(&column == &columns.back() ? "\n" : ",");
    }
  }
  return text;
}

TEST(Formats, ColumnsAreReadByTheNamesInTheHeader) {
  const TemporaryFolder folder;
  struct Case {
    std::string header;
    std::vector<std::string> columns;
    bool nanoseconds;
  };
  const std::vector<std::string> wxyz{"t", "x", "y", "z", "qw", "qx", "qy", "qz"};
  const std::vector<std::string> xyzw{"t", "x", "y", "z", "qx", "qy", "qz", "qw"};
  for (const auto& [header, columns, nanoseconds] : std::vector<Case>{
           {"#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []",
            wxyz, true},
           {"timestamp, p_WS_W_x, p_WS_W_y, p_WS_W_z, q_WS_x, q_WS_y, q_WS_z, q_WS_w", xyzw, false},
           {"ts (ns),tx (m),ty (m),tz (m),qx,qy,qz,qw", xyzw, true},
           {"#timestamp,x,y,z,qw,qx,qy,qz,vx", {"t", "x", "y", "z", "qw", "qx", "qy", "qz", "-"}, false},
           {"# timestamp tx ty tz qw qx qy qz", wxyz, false},
           {"# written by a tool at noon\n# time[s] x[m] y[m] z[m] qw qx qy qz", wxyz, false},
           {"timestamp_nanoseconds,x,y,z,qx,qy,qz,qw", xyzw, true},
           {"time_nsec,x,y,z,qx,qy,qz,qw", xyzw, true},
           {",time_ns,qw,qx,qy,qz,tx,ty,tz", {"-", "t", "qw", "qx", "qy", "qz", "x", "y", "z"}, true},
           {"%time,field.header.seq,field.pose.position.x,field.pose.position.y,field.pose.position.z,"
            "field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,"
            "field.pose.orientation.w",
            {"t", "-", "x", "y", "z", "qx", "qy", "qz", "qw"},
            false},
           {"%time,field.header.stamp,x,y,z,qx,qy,qz,qw",  // reception, measurement
            {"-", "t", "x", "y", "z", "qx", "qy", "qz", "qw"},
            true},
           {"t,x,y,z,vx,vy,vz,qw,qx,qy,qz,bgx",
            {"t", "x", "y", "z", "-", "-", "-", "qw", "qx", "qy", "qz", "-"},
            false}}) {
    const auto file = folder.write("named.csv", named_columns(header, columns, nanoseconds));
    SCOPED_TRACE(header);
    const LoadedTrajectory loaded = read_trajectory({.path = file});
    expect_same(loaded.trajectory, kPath);
    EXPECT_EQ(loaded.order_source, OrderSource::kNamed);
  }
}

/// The rows of `kPath` with the whole seconds and the rest of each stamp in two columns.
/// @param unit_ns of the rest
std::string split_stamps(const std::string& header, std::int64_t unit_ns, bool rest_first = false) {
  std::string text = header + "\n";
  for (const auto& [pose, t] : kPath.poses) {
    const std::string seconds = std::to_string(t.ns / 1'000'000'000);
    const std::string rest = std::to_string(t.ns % 1'000'000'000 / unit_ns);
    char row[200];
    std::snprintf(row, sizeof row, "%s,%s,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f\n",
                  (rest_first ? rest : seconds).c_str(), (rest_first ? seconds : rest).c_str(), pose.p.x(),
                  pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w());
    text += row;
  }
  return text;
}

TEST(Formats, SecondsAndNanosecondsInTwoColumnsAreOneStamp) {
  const TemporaryFolder folder;
  for (const std::string names :
       {"secs,nsecs", "sec,nanosec", "header.stamp.secs,header.stamp.nsecs", "# sec,nsec",
        "seconds,nanoseconds", "%field.header.stamp.secs,field.header.stamp.nsecs", "time_sec,time_nsec"}) {
    SCOPED_TRACE(names);
    const auto file = folder.write("split.csv", split_stamps(names + ",x,y,z,qx,qy,qz,qw", 1));
    const LoadedTrajectory loaded = read_trajectory({.path = file});
    expect_same(loaded.trajectory, kPath);
    EXPECT_EQ(loaded.order_source, OrderSource::kNamed);
    EXPECT_EQ(loaded.format, TrajectoryFormat::kTum);
  }
  const auto reversed = folder.write(
      "reversed.csv", split_stamps("header.stamp.nanosec,header.stamp.sec,x,y,z,qx,qy,qz,qw", 1, true));
  expect_same(read_trajectory({.path = reversed}).trajectory, kPath);
  const auto micro = folder.write("micro.csv", split_stamps("tv_sec,tv_usec,x,y,z,qx,qy,qz,qw", 1000));
  EXPECT_EQ(read_trajectory({.path = micro}).trajectory.poses[1].t.ns, kPath.poses[1].t.ns / 1000 * 1000);
}

TEST(Formats, TheStampOfTheHeaderIsPreferredToThatOfTheReception) {
  const TemporaryFolder folder;
  const auto file = folder.write("bagpy.csv",
                                 "Time,header.seq,header.stamp.secs,header.stamp.nsecs,position.x,position.y,"
                                 "position.z,orientation.x,orientation.y,orientation.z,orientation.w\n"
                                 "9.5,0,7,250000000,0,0,0,0,0,0,1\n9.6,1,7,350000000,0,0,0,0,0,0,1\n");
  const LoadedTrajectory loaded = read_trajectory({.path = file});
  EXPECT_EQ(loaded.trajectory.poses.at(1).t.ns, 7'350'000'000);
}

TEST(Formats, PartsOfAStampThatAreNoneAreAnError) {
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& stamp, const std::vector<std::string>& parts) {
    const auto file = folder.write("bad.csv", "secs,nsecs,x,y,z,qx,qy,qz,qw\n" + stamp + ",0,0,0,0,0,0,1\n");
    SCOPED_TRACE(stamp);
    expect_input_error([&] { static_cast<void>(read_trajectory({.path = file})); }, parts);
  };
  error_of("7,1000000000", {"bad.csv:2", "1000000000", "0 to 999999999"});  // the stamp itself, e.g. in ns
  error_of("7,-1", {"bad.csv:2", "-1"});
  error_of("7.5,500000000", {"bad.csv:2", "7.5", "whole"});
  error_of("9223372036,900000000", {"bad.csv:2", "292 years"});
  error_of("7,x", {"bad.csv:2", "\"x\""});
}

TEST(Formats, AHeaderThatNamesNoPoseIsAnError) {
  const TemporaryFolder folder;
  for (const std::string header :
       {"time,a,b,c,d,e,f,g", "t,x,y,z,roll,pitch,yaw,w", "t,x,x,z,qx,qy,qz,qw", "x,y,z,qx,qy,qz,qw,speed",
        "time,other_nsecs,x,y,z,qx,qy,qz,qw", "t (ms),x,y,z,qx,qy,qz,qw",
        "timestamp_usec,x,y,z,qx,qy,qz,qw,speed", "time_milliseconds,x,y,z,qx,qy,qz,qw,speed"}) {
    const auto file = folder.write("named.csv", header + "\n1,0,0,0,0,0,0,1,0\n2,0,0,0,0,0,0,1,0\n");
    SCOPED_TRACE(header);
    expect_input_error([&] { static_cast<void>(read_trajectory({.path = file})); }, {"named.csv:1"});
  }
}

TEST(Formats, NanosecondsWithoutAHeaderHaveAnAssumedOrder) {
  const TemporaryFolder folder;
  const std::string row = "1403636579763555584.000000 1 2 3 0 0 0 1\n";
  const LoadedTrajectory blanks = read_trajectory({.path = folder.write("orb_slam3.txt", row)});
  EXPECT_EQ(blanks.trajectory.poses.front().t, Timestamp{1403636579763555584});
  EXPECT_EQ(blanks.trajectory.poses.front().T_w_f.q.w(), 1.0);
  EXPECT_EQ(blanks.order_source, OrderSource::kAssumed);
  const LoadedTrajectory commas =
      read_trajectory({.path = folder.write("a.csv", "1403636579763555584,1,2,3,1,0,0,0\n")});
  EXPECT_EQ(commas.trajectory.poses.front().T_w_f.q.w(), 1.0);
  EXPECT_EQ(commas.order_source, OrderSource::kAssumed);
  expect_same(with_other_order(with_other_order(kPath, QuaternionOrder::kWxyz), QuaternionOrder::kXyzw),
              kPath);
}

TEST(Formats, MicrosecondsAreNotTakenForNanoseconds) {
  const TemporaryFolder folder;
  const auto rows = [](std::int64_t first, std::int64_t interval) {
    std::string text;
    for (int i = 0; i < 5; ++i) text += std::to_string(first + i * interval) + " 1 2 3 0 0 0 1\n";
    return text;
  };
  constexpr std::int64_t kMicroseconds = 1305031100000000;  // since 1970; as nanoseconds, 15 days
  for (const std::int64_t interval : {50'000, 1'000'000, 5'000'000}) {
    const auto file = folder.write("us.txt", rows(kMicroseconds, interval));
    expect_input_error([&] { static_cast<void>(read_trajectory({.path = file})); },
                       {"us.txt: as nanoseconds, the stamps are", "seem to be in microseconds"});
  }
  const auto fast = folder.write("fast.txt", rows(1'000 * kMicroseconds, 1'000'000));  // 1 kHz
  EXPECT_EQ(read_trajectory({.path = fast}).trajectory.poses.size(), 5U);
  const auto slow = folder.write("uptime.txt", rows(kMicroseconds, 33'000'000));  // 30 Hz
  EXPECT_EQ(read_trajectory({.path = slow}).trajectory.poses.size(), 5U);
  const auto named =
      folder.write("named.txt", "# t[ns] x y z qx qy qz qw\n" + rows(kMicroseconds, 5'000'000));
  EXPECT_EQ(read_trajectory({.path = named}).trajectory.poses.size(), 5U);
}

TEST(Formats, SecondsWithCommasAndWithoutAHeaderHaveAnAssumedOrder) {
  const TemporaryFolder folder;
  const auto source_of = [&](const std::string& row, std::optional<TrajectoryFormat> format = std::nullopt) {
    return read_trajectory({.path = folder.write("rows.txt", row), .format = format}).order_source;
  };
  EXPECT_EQ(source_of("1.5,1,2,3,0,0,0,1\n"), OrderSource::kAssumed);
  EXPECT_EQ(source_of("1.5;1;2;3;0;0;0;1\n"), OrderSource::kAssumed);
  EXPECT_EQ(source_of("1.5 1 2 3 0 0 0 1\n"), OrderSource::kFormat);
  EXPECT_EQ(source_of("1.5,1,2,3,0,0,0,1\n", TrajectoryFormat::kTum), OrderSource::kFormat);
  EXPECT_EQ(source_of("t,x,y,z,qw,qx,qy,qz\n1.5,1,2,3,1,0,0,0\n"), OrderSource::kNamed);
}

TEST(Formats, TimesInAnotherUnitAreNamedWithTheirFile) {
  std::string poses;
  for (int i = 0; i < 3; ++i) poses += "1 0 0 0 0 1 0 0 0 0 1 0\n";
  expect_input_error([&] { static_cast<void>(parse_kitti(poses, "p", "0\n50000000\n100000000\n", "t")); },
                     {"t: as seconds", "nanoseconds"});
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
