// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/foxglove/messages.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>

#include "datasets/bags/bag_geometry.h"
#include "datasets/bags/mcap.h"
#include "datasets/foxglove/message_types.h"
#include "datasets/foxglove/protobuf.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

const Pose kPose{Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {1.25, -2.0, 1e-300}};

/// Poses at 0, 10, 20 ... ms, in chunks of about 6,000.
void write_poses(McapWriter& writer, int count) {
  const std::uint32_t channel = writer.add_channel({.topic = "/estimate",
                                                    .message_encoding = "protobuf",
                                                    .type = std::string(kPoseInFrameType),
                                                    .schema_encoding = "protobuf",
                                                    .schema = protobuf_schema(kPoseInFrameType)});
  for (int i = 0; i < count; ++i) {
    const Timestamp t{1'000'000'000 + i * std::int64_t{10'000'000}};
    writer.write(channel, t, encode_pose_in_frame({t, "world"}, {kPose.q, {0.001 * i, 0.0, 0.0}}));
  }
}

TEST(FoxgloveMessages, DecodeReturnsTheEncodedPose) {
  const Timestamp t{1'700'000'000'123'456'789};
  const PoseInFrameMessage decoded = decode_pose_in_frame(encode_pose_in_frame({t, "world"}, kPose), "file");
  EXPECT_EQ(decoded.t, t);
  EXPECT_EQ(decoded.frame, "world");
  EXPECT_EQ(decoded.position, kPose.p);
  EXPECT_EQ(decoded.orientation.coeffs(), kPose.q.coeffs());
}

TEST(FoxgloveMessages, EveryPrefixOfAPoseIsAnErrorOrAnIncompletePose) {
  const std::string bytes = encode_pose_in_frame({{1'000'000'005}, "world"}, kPose);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    try {
      const PoseInFrameMessage decoded = decode_pose_in_frame(bytes.substr(0, size), "file");
      EXPECT_EQ(decoded.orientation.norm(), 0.0) << size;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("file"), std::string::npos);
    }
  }
}

TEST(FoxgloveMessages, AnIntegerOfMoreThan64BitsIsAnError) {
  const std::string bytes = "\x08" + std::string(11, '\xff');
  expect_input_error([&] { static_cast<void>(decode_pose_in_frame(bytes, "file")); }, {"64 bits"});
}

TEST(FoxgloveMessages, ADeepImageHasItsSizeAndPixels) {
  constexpr std::array<std::uint16_t, 6> kPixels = {1, 256, 65535, 4, 5, 6};
  const std::string bytes = encode_deep_image({{5}, "camera"}, 3, kPixels);
  ProtobufReader reader(bytes, "file");
  std::map<int, ProtobufField> fields;
  while (const auto field = reader.next()) fields[field->number] = *field;
  EXPECT_EQ(fields[2].value, 3U);  // width
  EXPECT_EQ(fields[3].value, 2U);  // height
  EXPECT_EQ(fields[4].bytes, "16UC1");
  EXPECT_EQ(fields[5].value, 6U);  // bytes of a row
  EXPECT_EQ(fields[6].bytes, std::string("\1\0\0\1\xff\xff\4\0\5\0\6\0", 12));
}

TEST(FoxgloveMessages, MasksHaveOneByteAPixel) {
  constexpr std::array<std::uint8_t, 6> kPixels = {0, 255, 0, 1, 2, 3};
  const std::string bytes = encode_mono_image({{5}, "camera"}, 3, kPixels);
  ProtobufReader reader(bytes, "file");
  std::map<int, ProtobufField> fields;
  while (const auto field = reader.next()) fields[field->number] = *field;
  EXPECT_EQ(fields[3].value, 2U);  // height
  EXPECT_EQ(fields[4].bytes, "mono8");
  EXPECT_EQ(fields[5].value, 3U);  // bytes of a row
  EXPECT_EQ(fields[6].bytes, std::string("\0\xff\0\1\2\3", 6));
}

TEST(FoxgloveMessages, PosesOfAnMcapFileAreReadAsATrajectory) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "run.mcap";
  McapWriter writer(file, ChunkCompression::kZstd, "");
  write_poses(writer, 100);
  writer.finish();
  const eval::LoadedTrajectory loaded = read_bag_trajectory(BagTopic{file, "/estimate"});
  ASSERT_EQ(loaded.trajectory.poses.size(), 100U);
  EXPECT_EQ(loaded.trajectory.poses[7].t, Timestamp{1'070'000'000});
  EXPECT_EQ(loaded.trajectory.poses[7].T_w_f.p.x(), 0.001 * 7);
  EXPECT_EQ(loaded.trajectory.poses[7].T_w_f.q.coeffs(), kPose.q.coeffs());
}

TEST(FoxgloveMessages, TheFileOfAKilledProcessIsReadUpToItsLastChunk) {
  const TemporaryFolder folder;
  const fs::path copy = folder.path() / "killed.mcap";
  {
    McapWriter writer(folder.path() / "run.mcap", ChunkCompression::kLz4, "");
    write_poses(writer, 20'000);
    fs::copy_file(folder.path() / "run.mcap.part", copy);
  }
  const BagFile bag(copy);
  EXPECT_FALSE(bag.is_complete());
  const std::size_t poses = read_bag_trajectory(bag, "/estimate").trajectory.poses.size();
  EXPECT_GT(poses, 10'000U);
  EXPECT_LT(poses, 20'000U);
}

}  // namespace
}  // namespace stillpoint::datasets
