// SPDX-License-Identifier: BSD-3-Clause
/// Compares reader and writer with the ROS 1 library of Debian (python3-rosbag).
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "datasets/bags/bag_file.h"
#include "datasets/bags/messages.h"
#include "datasets/sequence_export.h"
#include "tests/support/sequences/small_stream.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

/// The interpreter for which Debian's packages are installed.
const std::string kPython = "/usr/bin/python3";
const std::string kOracle = std::string(STILLPOINT_SOURCE_DIR) + "/tests/unit/bags/rosbag_oracle.py";

bool has_oracle() {
  return std::system((kPython + " -c 'import rosbag, tf2_msgs.msg, nav_msgs.msg' 2>/dev/null").c_str()) == 0;
}

constexpr const char* kMissing = "python3-rosbag is not installed (scripts/setup.sh --oracles)";

/// Runs the oracle; its output is in the file `output`.
int run_oracle(const std::string& arguments, const std::filesystem::path& output) {
  return std::system((kPython + " " + kOracle + " " + arguments + " >" + output.string() + " 2>&1").c_str());
}

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// Expects the values of messages() in the script.
void expect_message(const std::string& topic, const SerializedMessage& message, int i) {
  const Eigen::Vector3d value(i, i + 0.5, -i);
  const bool has_header = topic != "/tf";
  EXPECT_EQ(has_header ? parse_header(message).stamp.ns : 0,
            has_header ? (100 + i) * std::int64_t{1'000'000'000} + 7 * i : 0);
  if (topic == "/image") {
    const ImageMessage image = parse_image(message);
    ASSERT_EQ(image.data.size(), 3600U);
    EXPECT_EQ(image.step, 90U);
    EXPECT_EQ(image.encoding, "rgb8");
    for (int j = 0; j < 3600; ++j)
      ASSERT_EQ(static_cast<std::uint8_t>(image.data[static_cast<std::size_t>(j)]), (j * i) % 256);
  } else if (topic == "/imu") {
    const ImuMessage imu = parse_imu(message);
    EXPECT_EQ(imu.gyro, value);
    EXPECT_EQ(imu.accel, Eigen::Vector3d(i / 3.0, i / 3.0 + 0.5, -(i / 3.0)));
  } else if (topic == "/pose") {
    EXPECT_EQ(parse_pose(message, "geometry_msgs/PoseStamped").pose->p, value);
  } else if (topic == "/odom") {
    EXPECT_EQ(parse_pose(message, "nav_msgs/Odometry").pose->p, value);
    EXPECT_EQ(parse_pose(message, "nav_msgs/Odometry").child, "base");
  } else if (topic == "/transform") {
    EXPECT_EQ(parse_pose(message, "geometry_msgs/TransformStamped").pose->p, value);
  } else if (topic == "/info") {
    const CameraInfoMessage info = parse_camera_info(message);
    EXPECT_EQ(info.D, (std::vector<double>{0.1, 0.2, 0.3, 0.4, 0.5 * i}));
    EXPECT_EQ(info.K[0], 500.0 + i);
    EXPECT_EQ(info.width, 640U);
  } else if (topic == "/fix") {
    EXPECT_EQ(parse_nav_sat_fix(message).latitude_deg, 48.0 + i);
  } else if (topic == "/compressed") {
    EXPECT_EQ(parse_compressed_image(message).data, (std::string{static_cast<char>(i), 2, 3}));
  } else {
    ASSERT_EQ(topic, "/tf");
    const std::vector<PoseMessage> transforms = parse_transforms(message);
    ASSERT_EQ(transforms.size(), 2U);
    EXPECT_EQ(transforms[1].header.frame, "parent");
    EXPECT_EQ(transforms[1].pose->p, value);
  }
}

class RosbagOracle : public testing::TestWithParam<const char*> {};

TEST_P(RosbagOracle, ItsBagsAreReadToEqualContent) {
  if (!has_oracle()) GTEST_SKIP() << kMissing;
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "oracle.bag";
  ASSERT_EQ(run_oracle("write " + path.string() + " " + GetParam(), folder.path() / "log"), 0)
      << text_of(folder.path() / "log");
  const BagFile bag(path);
  EXPECT_TRUE(bag.warnings().empty());
  std::map<std::string, int> counts;
  for (const MessageReference& reference : bag.messages()) {
    const std::string& topic = bag.connection(reference).topic;
    const int i = counts[topic]++;
    EXPECT_EQ(reference.message.t.ns, (200 + i) * std::int64_t{1'000'000'000} + i);
    const std::string bytes = bag.payload(reference);
    expect_message(topic, {.bytes = bytes, .format = bag.connection(reference).format, .place = topic}, i);
  }
  ASSERT_EQ(counts.size(), 9U);
  for (const auto& [topic, count] : counts) EXPECT_EQ(count, 50) << topic;
}

TEST_P(RosbagOracle, ItReadsExportedBags) {
  if (!has_oracle()) GTEST_SKIP() << kMissing;
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "own.bag";
  export_bag(SmallStream(), path, GetParam());
  ASSERT_EQ(run_oracle("read " + path.string(), folder.path() / "log"), 0) << text_of(folder.path() / "log");
  const std::string text = text_of(folder.path() / "log");
  const auto expect_line = [&text](const std::string& line) {
    EXPECT_NE(text.find(line), std::string::npos) << line << " in\n" << text;
  };
  expect_line("/camera/color/image_raw 1700000000033333333 mono8 8 6 48 10");
  expect_line("/camera/aligned_depth_to_color/image_raw 1700000000066666666 16UC1 8 6 96 232");  // 1000 = 3 *
                                                                                                 // 256 + 232
  expect_line("/camera/imu 1700000000000000000 0.3333333333333333 9.81");
  expect_line("/camera/color/camera_info 1700000000000000000 5.0 5.5 0.0");
  expect_line("/tf_static 1700000000000000000 camera_color_optical_frame 0.3");
  expect_line("/ground_truth 1700000000066666666 camera_color_optical_frame 2.0");
}

INSTANTIATE_TEST_SUITE_P(AllCompressions, RosbagOracle, testing::Values("none", "bz2", "lz4"));

}  // namespace
}  // namespace stillpoint::datasets
