// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/bag_geometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/bags/bag_file.h"
#include "datasets/bags/messages.h"
#include "eval/io/nmea_file.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

Timestamp at_ms(std::int64_t ms) { return {1'000'000'000 + ms * 1'000'000}; }

Pose shifted(double x, double y = 0.0) { return {Eigen::Quaterniond::Identity(), {x, y, 0.0}}; }

PoseMessage link(const std::string& parent, const std::string& child, Timestamp t, const Pose& pose) {
  return {.header = {.stamp = t, .frame = parent}, .child = child, .pose = pose};
}

/// map -> odom at 1 Hz moves along y, odom -> base at 10 Hz along x, base -> camera is fixed.
std::filesystem::path write_transforms(const TemporaryFolder& folder) {
  BagWriter writer(folder.path() / "tf.bag", ChunkCompression::kNone);
  const std::uint32_t moving = writer.add_connection("/tf", "tf2_msgs/TFMessage");
  const std::uint32_t fixed = writer.add_connection("/tf_static", "tf2_msgs/TFMessage");
  const std::vector<PoseMessage> camera{link("base", "camera", at_ms(0), shifted(0.5))};
  writer.write(fixed, at_ms(0), serialize_transforms(camera, writer.format()));
  for (int i = 0; i <= 10; ++i) {
    std::vector<PoseMessage> links{link("odom", "base", at_ms(100 * i), shifted(0.1 * i))};
    if (i % 10 == 0) links.push_back(link("map", "odom", at_ms(100 * i), shifted(0.0, 0.1 * i)));
    links.push_back(link("map", "person", at_ms(100 * i), shifted(7.0)));
    writer.write(moving, at_ms(100 * i), serialize_transforms(links, writer.format()));
  }
  writer.finish();
  return folder.path() / "tf.bag";
}

TEST(BagTrajectory, AChainOfTransformsIsInterpolatedAtTheFastestLink) {
  const TemporaryFolder folder;
  const BagFile bag(write_transforms(folder));
  const eval::LoadedTrajectory loaded = read_bag_trajectory(bag, "/tf:map.camera");
  const std::vector<StampedPose>& poses = loaded.trajectory.poses;
  ASSERT_EQ(poses.size(), 11U);
  EXPECT_EQ(loaded.trajectory.frame, "camera");
  EXPECT_EQ(poses[3].t, at_ms(300));
  EXPECT_NEAR((poses[3].T_w_f.p - Eigen::Vector3d(0.3 + 0.5, 0.3, 0.0)).norm(), 0.0, 1e-12);
}

/// odom -> base at 10 Hz for 4 s, and map -> odom at these times and positions.
eval::LoadedTrajectory with_map(std::initializer_list<std::pair<int, double>> map_y) {
  const TemporaryFolder folder;
  BagWriter writer(folder.path() / "tf.bag", ChunkCompression::kNone);
  const std::uint32_t topic = writer.add_connection("/tf", "tf2_msgs/TFMessage");
  const auto write = [&](const PoseMessage& message) {
    writer.write(topic, message.header.stamp, serialize_transforms(std::span(&message, 1), writer.format()));
  };
  for (int i = 0; i <= 40; ++i) write(link("odom", "base", at_ms(100 * i), shifted(0.1 * i)));
  for (const auto& [ms, y] : map_y) write(link("map", "odom", at_ms(ms), shifted(0.0, y)));
  writer.finish();
  return read_bag_trajectory(BagFile(folder.path() / "tf.bag"), "/tf:map.base");
}

TEST(BagTrajectory, ALinkThatNeverChangesHoldsForTheWholeChain) {
  for (const eval::LoadedTrajectory& loaded : {with_map({{0, 2.0}}), with_map({{0, 2.0}, {3000, 2.0}})}) {
    ASSERT_EQ(loaded.trajectory.poses.size(), 41U);
    EXPECT_NEAR((loaded.trajectory.poses[40].T_w_f.p - Eigen::Vector3d(4.0, 2.0, 0.0)).norm(), 0.0, 1e-12);
    EXPECT_TRUE(eval::repair_texts(loaded.repairs).empty());
  }
}

TEST(BagTrajectory, TimesWithoutATransformOfAnotherLinkAreCounted) {
  const eval::LoadedTrajectory loaded = with_map({{0, 1.0}, {1000, 1.5}, {3000, 2.0}});
  EXPECT_EQ(loaded.trajectory.poses.size(), 12U);  // 0 to 1 s, and 3 s
  EXPECT_EQ(loaded.repairs.skipped, 29U);
  EXPECT_EQ(eval::repair_texts(loaded.repairs).front(),
            "29 rows skipped: no valid pose (a link of /tf without a transform within 1 s)");
}

TEST(BagTrajectory, UnknownFramesListTheMovingOnes) {
  const TemporaryFolder folder;
  const BagFile bag(write_transforms(folder));
  const auto read = [&bag](const std::string& topic) { static_cast<void>(read_bag_trajectory(bag, topic)); };
  expect_input_error([&] { read("/tf:map.gripper"); }, {"no chain of transforms", "map.odom"});
  expect_input_error([&] { read("/tf:base.camera"); }, {"does not move"});
  expect_input_error([&] { read("/tf:map"); }, {"/tf:PARENT.CHILD"});
  expect_input_error([&] { read("/pose"); }, {"tf.bag:/pose", "contains no poses", "/tf"});
  expect_input_error([&] { read("/tf_static"); }, {"tf2_msgs/TFMessage", "contains no pose"});
}

TEST(BagTrajectory, OfASplitBagIsThatOfAllParts) {
  const TemporaryFolder folder;
  const auto write_part = [&](const std::string& name, int first, int count) {
    std::filesystem::create_directories((folder.path() / name).parent_path());
    BagWriter writer(folder.path() / name, ChunkCompression::kNone);
    const std::uint32_t topic = writer.add_connection("/pose", "geometry_msgs/PoseStamped");
    for (int i = first; i < first + count; ++i)
      writer.write(topic, at_ms(10 * i),
                   serialize_pose(link("map", "", at_ms(10 * i), shifted(i)), "geometry_msgs/PoseStamped",
                                  writer.format()));
    writer.finish();
  };
  write_part("split/run_2026-01-01-10-00-00_0.bag", 0, 5);
  EXPECT_FALSE(eval::is_bag(folder.path() / "split"));  // one part may be named as a file
  write_part("split/run_2026-01-01-10-05-00_1.bag", 5, 4);
  ASSERT_TRUE(eval::is_bag(folder.path() / "split"));
  const eval::LoadedTrajectory loaded = read_bag_trajectory(BagFile(folder.path() / "split"), "/pose");
  ASSERT_EQ(loaded.trajectory.poses.size(), 9U);
  EXPECT_EQ(loaded.trajectory.poses.back().T_w_f.p.x(), 8.0);
  for (const char* other : {"split/run_3.bag", "split/other_2.bag", "split/depth/a.png"}) {
    folder.write(other, "x");
    EXPECT_FALSE(eval::is_bag(folder.path() / "split"))
        << other;  // a part is missing; another bag; a dataset
    std::filesystem::remove(folder.path() / other);
  }
}

TEST(BagTrajectory, PosesAreSortedAndRepairsCounted) {
  const TemporaryFolder folder;
  BagWriter writer(folder.path() / "poses", ChunkCompression::kNone);
  const std::uint32_t odometry = writer.add_connection("/odom", "nav_msgs/Odometry");
  const Pose no_rotation{Eigen::Quaterniond(0, 0, 0, 0), {0, 0, 0}};
  const auto write = [&](std::int64_t stamp_ms, std::int64_t recorded_ms, const Pose& pose) {
    const Timestamp stamp = stamp_ms < 0 ? Timestamp{0} : at_ms(stamp_ms);
    writer.write(odometry, at_ms(recorded_ms),
                 serialize_pose(link("odom", "base", stamp, pose), "nav_msgs/Odometry", writer.format()));
  };
  write(0, 0, shifted(0));
  write(20, 10, shifted(2));
  write(10, 20, shifted(1));
  write(10, 21, shifted(9));
  write(25, 25, no_rotation);
  write(-1, 30, shifted(3));  // without a stamp
  writer.finish();
  const eval::LoadedTrajectory loaded = read_bag_trajectory(BagFile(folder.path() / "poses"), "/odom");
  ASSERT_EQ(loaded.trajectory.poses.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(loaded.trajectory.poses[i].t, at_ms(10 * static_cast<std::int64_t>(i)));
    EXPECT_EQ(loaded.trajectory.poses[i].T_w_f.p.x(), static_cast<double>(i));
  }
  EXPECT_EQ(loaded.repairs.skipped, 1U);
  EXPECT_EQ(loaded.repairs.repeated, 1U);
  EXPECT_EQ(loaded.repairs.reordered, 1U);
  EXPECT_EQ(loaded.repairs.unstamped, 1U);
  EXPECT_EQ(eval::repair_texts(loaded.repairs).back(),
            "1 row with the stamp 0: the time of recording is used");
  EXPECT_EQ(loaded.trajectory.frame, "base");
}

TEST(BagTrajectory, FixesOfAGnssReceiverBecomePositionsInAPlane) {
  const TemporaryFolder folder;
  BagWriter writer(folder.path() / "gnss.bag", ChunkCompression::kNone);
  const std::uint32_t topic = writer.add_connection("/fix", "sensor_msgs/NavSatFix");
  const auto write = [&](int i, int status, double latitude_deg) {
    const NavSatFixMessage fix{.header = {.stamp = at_ms(100 * i), .frame = "gps"},
                               .status = static_cast<std::int8_t>(status),
                               .latitude_deg = latitude_deg,
                               .longitude_deg = 11.0,
                               .altitude_m = 500.0};
    writer.write(topic, at_ms(100 * i), serialize(fix, writer.format()));
  };
  write(0, -1, 0.0);  // no fix
  write(1, 0, 48.0);
  write(2, 0, NAN);
  write(3, 2, 48.0 + 1e-4);
  writer.finish();
  const BagFile bag(folder.path() / "gnss.bag");
  for (const char* const name : {"/fix", "fix"}) {
    const eval::LoadedTrajectory loaded = read_bag_trajectory(bag, name);
    ASSERT_EQ(loaded.trajectory.poses.size(), 2U) << name;
    EXPECT_EQ(loaded.trajectory.frame, eval::kGnssFrame);
    EXPECT_EQ(loaded.repairs.skipped, 2U);
    // A degree of latitude is 111.2 km at 48 degrees.
    EXPECT_NEAR(loaded.trajectory.poses[1].T_w_f.p.y(), 11.12, 0.01);
    EXPECT_NEAR(loaded.trajectory.poses[1].T_w_f.p.x(), 0.0, 1e-6);
  }
}

/// NaN is the altitude of fixes in two dimensions.
TEST(BagTrajectory, FixesWithoutAltitudeAreSkippedWhereOthersHaveOne) {
  const auto heights_of = [](std::initializer_list<double> altitudes) {
    const TemporaryFolder folder;
    BagWriter writer(folder.path() / "gnss.bag", ChunkCompression::kNone);
    const std::uint32_t topic = writer.add_connection("/fix", "sensor_msgs/NavSatFix");
    for (int i = 0; const double altitude_m : altitudes) {
      const Timestamp t = at_ms(100 * i++);
      const NavSatFixMessage fix{.header = {.stamp = t, .frame = "gps"},
                                 .status = 0,
                                 .latitude_deg = 48.0,
                                 .longitude_deg = 11.0,
                                 .altitude_m = altitude_m};
      writer.write(topic, t, serialize(fix, writer.format()));
    }
    writer.finish();
    std::vector<double> heights;
    for (const StampedPose& pose :
         read_bag_trajectory(BagFile(folder.path() / "gnss.bag"), "/fix").trajectory.poses)
      heights.push_back(pose.T_w_f.p.z());
    return heights;
  };
  const std::vector<double> heights = heights_of({NAN, 500.0, NAN, 501.0});
  ASSERT_EQ(heights.size(), 2U);
  EXPECT_NEAR(heights[1], 1.0, 1e-6);
  EXPECT_EQ(heights_of({NAN, NAN, NAN}).size(), 3U);
}

TEST(BagTrajectory, CovariancesOfOdometryAreRead) {
  const TemporaryFolder folder;
  BagWriter writer(folder.path() / "odom.bag", ChunkCompression::kNone);
  const std::uint32_t with = writer.add_connection("/odom", "nav_msgs/Odometry");
  const std::uint32_t without = writer.add_connection("/pose", "geometry_msgs/PoseStamped");
  PoseMessage pose = link("odom", "base", at_ms(0), shifted(1));
  pose.covariance.emplace();
  for (std::size_t i = 0; i < 6; ++i) (*pose.covariance)[7 * i] = 1.0 + static_cast<double>(i);
  writer.write(with, at_ms(0), serialize_pose(pose, "nav_msgs/Odometry", writer.format()));
  writer.write(without, at_ms(0), serialize_pose(pose, "geometry_msgs/PoseStamped", writer.format()));
  writer.finish();
  const auto rows = read_bag_covariances({.bag = folder.path() / "odom.bag", .topic = "/odom"});
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].t, at_ms(0));
  EXPECT_EQ(rows[0].position.diagonal(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(rows[0].rotation.diagonal(), Eigen::Vector3d(4, 5, 6));
  EXPECT_TRUE(read_bag_covariances({.bag = folder.path() / "odom.bag", .topic = "/pose"}).empty());
}

TEST(BagTrajectory, ArgumentsAreBagsAndTopics) {
  EXPECT_EQ(parse_bag_topic("a/b.bag:/gt")->topic, "/gt");
  EXPECT_EQ(parse_bag_topic("a/b.mcap:/tf:map.base")->bag, "a/b.mcap");
  EXPECT_EQ(parse_bag_topic("a/b.mcap:/tf:map.base")->topic, "/tf:map.base");
  EXPECT_EQ(parse_bag_topic("a/b.bag:odom")->topic, "/odom");
  EXPECT_FALSE(parse_bag_topic("a/b.txt:/gt"));
  EXPECT_FALSE(parse_bag_topic("a/b.bag"));
}

}  // namespace
}  // namespace stillpoint::datasets
