// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/bags/messages.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint::datasets {
namespace {

const MessageHeader kHeader{.stamp = {1'700'000'000'123'456'789}, .frame = "cam"};
const Pose kPose{Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {1.0, 2.0, 3.0}};

class Messages : public testing::TestWithParam<WireFormat> {
 protected:
  /// The message with these bytes, which must outlive it.
  [[nodiscard]] static SerializedMessage message(const std::string& bytes) {
    return {.bytes = bytes, .format = GetParam(), .place = "bag"};
  }

  static void expect_header(const MessageHeader& header) {
    EXPECT_EQ(header.stamp, kHeader.stamp);
    EXPECT_EQ(header.frame, "cam");
  }

  static void expect_pose(const PoseMessage& pose) {
    expect_header(pose.header);
    ASSERT_TRUE(pose.pose);
    EXPECT_EQ(pose.pose->q.coeffs(), kPose.q.coeffs());
    EXPECT_EQ(pose.pose->p, kPose.p);
  }
};

INSTANTIATE_TEST_SUITE_P(Both, Messages, testing::Values(WireFormat::kRos1, WireFormat::kCdr));

TEST_P(Messages, ImuKeepsAllBits) {
  const std::string bytes = serialize(
      ImuMessage{.header = kHeader, .gyro = {0.1, 0.2, 1.0 / 3.0}, .accel = {1, 2, -9.81}}, GetParam());
  const ImuMessage imu = parse_imu(message(bytes));
  expect_header(imu.header);
  EXPECT_EQ(imu.gyro, Eigen::Vector3d(0.1, 0.2, 1.0 / 3.0));
  EXPECT_EQ(imu.accel, Eigen::Vector3d(1, 2, -9.81));
}

TEST_P(Messages, ImagesKeepTheirFields) {
  const std::string bytes = serialize(ImageMessage{.header = kHeader,
                                                   .height = 2,
                                                   .width = 3,
                                                   .encoding = "mono8",
                                                   .big_endian = false,
                                                   .step = 4,
                                                   .data = "12345678"},
                                      GetParam());
  const ImageMessage image = parse_image(message(bytes));
  expect_header(image.header);
  EXPECT_EQ(image.height, 2U);
  EXPECT_EQ(image.width, 3U);
  EXPECT_EQ(image.encoding, "mono8");
  EXPECT_EQ(image.step, 4U);
  EXPECT_EQ(image.data, "12345678");
  const std::string compressed =
      serialize(CompressedImageMessage{.header = kHeader, .format = "jpeg", .data = "abc"}, GetParam());
  EXPECT_EQ(parse_compressed_image(message(compressed)).format, "jpeg");
  EXPECT_EQ(parse_compressed_image(message(compressed)).data, "abc");
}

TEST_P(Messages, CameraInfoKeepsItsCalibration) {
  CameraInfoMessage info{.header = kHeader,
                         .height = 480,
                         .width = 640,
                         .distortion_model = "plumb_bob",
                         .D = {0.1, 0.2, 0.3, 0.4, 0.5}};
  info.K = {500.5, 0, 320, 0, 501, 240, 0, 0, 1};
  info.P[5] = 7.0;
  const std::string bytes = serialize(info, GetParam());
  const CameraInfoMessage read = parse_camera_info(message(bytes));
  EXPECT_EQ(read.height, 480U);
  EXPECT_EQ(read.D, info.D);
  EXPECT_EQ(read.K, info.K);
  EXPECT_EQ(read.P, info.P);
  EXPECT_EQ(read.distortion_model, "plumb_bob");
}

TEST_P(Messages, AllTypesOfPosesAreParsed) {
  for (const char* type : {"geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped",
                           "geometry_msgs/TransformStamped", "nav_msgs/Odometry"}) {
    ASSERT_TRUE(is_pose_type(type));
    const std::string bytes =
        serialize_pose({.header = kHeader, .child = "base", .pose = kPose}, type, GetParam());
    expect_pose(parse_pose(message(bytes), type));
  }
  EXPECT_FALSE(is_pose_type("sensor_msgs/Imu"));
}

TEST_P(Messages, TransformsAreParsedWithTheirFrames) {
  const std::vector<PoseMessage> sent{
      {.header = {.stamp = kHeader.stamp, .frame = "/cam"}, .child = "/imu", .pose = kPose},
      {.header = kHeader, .child = "b", .pose = Pose{}}};
  const std::string bytes = serialize_transforms(sent, GetParam());
  const std::vector<PoseMessage> read = parse_transforms(message(bytes));
  ASSERT_EQ(read.size(), 2U);
  expect_pose(read[0]);
  EXPECT_EQ(read[0].child, "imu");
  EXPECT_EQ(read[1].child, "b");
}

TEST_P(Messages, NavSatFixIsParsed) {
  const std::string bytes = serialize(
      NavSatFixMessage{
          .header = kHeader, .status = -1, .latitude_deg = 48.1, .longitude_deg = 11.5, .altitude_m = 520},
      GetParam());
  const NavSatFixMessage fix = parse_nav_sat_fix(message(bytes));
  EXPECT_EQ(fix.status, -1);
  EXPECT_EQ(fix.latitude_deg, 48.1);
  EXPECT_EQ(fix.altitude_m, 520);
}

TEST_P(Messages, EveryTruncationIsAnError) {
  const std::string bytes = serialize_transforms(
      std::vector<PoseMessage>{{.header = kHeader, .child = "b", .pose = kPose}}, GetParam());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::string part = bytes.substr(0, size);
    expect_input_error([&] { static_cast<void>(parse_transforms(message(part))); }, {"bag", "damaged"});
  }
}

TEST_P(Messages, APoseWithoutRotationIsNoPose) {
  const PoseMessage sent{
      .header = kHeader, .child = "b", .pose = Pose{Eigen::Quaterniond(0, 0, 0, 0), {1, 2, 3}}};
  const std::string bytes = serialize_pose(sent, "geometry_msgs/PoseStamped", GetParam());
  EXPECT_FALSE(parse_pose(message(bytes), "geometry_msgs/PoseStamped").pose);
}

/// CDR of a std_msgs/Float32 and of a Transform by hand: identifier, options, then the numbers.
TEST(Cdr, BigEndianNumbersAreRead) {
  const std::string bytes{"\0\0\0\0\x3f\x80\0\0", 8};  // 1.0f
  EXPECT_EQ(parse_float({.bytes = bytes, .format = WireFormat::kCdr, .place = "bag"}), 1.0F);
}

TEST(Cdr, Version2AlignsLongNumbersToFourBytes) {
  // Header: sec 1, nanosec 2, frame "ab" (length 3 with its 0, one byte of padding), then six doubles; the
  // first begins at byte 16 in both versions. With the frame "abcde" it begins at 20 in version 2, at 24 in
  // version 1.
  std::string body{"\1\0\0\0\2\0\0\0\6\0\0\0abcde\0\0\0", 20};
  for (int i = 0; i < 7; ++i) body += std::string("\0\0\0\0\0\0\xf0\x3f", 8);  // 1.0
  const std::string bytes = std::string("\0\7\0\0", 4) + body;
  const PoseMessage pose =
      parse_pose({.bytes = bytes, .format = WireFormat::kCdr, .place = "bag"}, "geometry_msgs/PoseStamped");
  EXPECT_EQ(pose.header.stamp.ns, 1'000'000'002);
  ASSERT_TRUE(pose.pose);
  EXPECT_EQ(pose.pose->p, Eigen::Vector3d(1, 1, 1));
}

TEST(Cdr, OtherEncapsulationsAreRejected) {
  const std::string bytes{"\0\3\0\0\0\0\0\0", 8};  // parameter list
  expect_input_error(
      [&] { static_cast<void>(parse_float({.bytes = bytes, .format = WireFormat::kCdr, .place = "bag"})); },
      {"bag", "not plain CDR"});
}

}  // namespace
}  // namespace stillpoint::datasets
