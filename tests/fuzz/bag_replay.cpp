// SPDX-License-Identifier: BSD-3-Clause
/// Runs the fuzz target on small bags and random mutations of them, with a fixed random seed.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "datasets/bags/bag_file.h"
#include "datasets/bags/messages.h"
#include "tests/support/temporary_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace stillpoint::datasets {
namespace {

constexpr int kMutations = 3000;

int run_target(const std::string& bytes) {
  return LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

/// One message of each kind that `run_target` parses.
std::vector<std::pair<std::string, std::string>> small_messages(WireFormat format) {
  const MessageHeader header{.stamp = {1'500'000'000}, .frame = "cam"};
  const PoseMessage pose{.header = header, .child = "imu", .pose = Pose{}};
  return {{"sensor_msgs/Image",
           serialize(
               ImageMessage{
                   .header = header, .height = 2, .width = 2, .encoding = "mono8", .step = 2, .data = "abcd"},
               format)},
          {"sensor_msgs/CompressedImage",
           serialize(CompressedImageMessage{.header = header, .format = "png", .data = "x"}, format)},
          {"sensor_msgs/CameraInfo",
           serialize(
               CameraInfoMessage{
                   .header = header, .height = 2, .width = 2, .distortion_model = "plumb_bob", .D = {0.1}},
               format)},
          {"sensor_msgs/Imu",
           serialize(ImuMessage{.header = header, .gyro = {1, 2, 3}, .accel = {4, 5, 6}}, format)},
          {"nav_msgs/Odometry", serialize_pose(pose, "nav_msgs/Odometry", format)},
          {"tf2_msgs/TFMessage", serialize_transforms(std::vector<PoseMessage>{pose, pose}, format)}};
}

std::string small_bag(const std::string& name, ChunkCompression compression) {
  const TemporaryFolder folder;
  BagWriter writer(folder.path() / name, compression);
  std::int64_t t = 1;
  for (const auto& [type, bytes] : small_messages(writer.format())) {
    const bool transforms = type == "tf2_msgs/TFMessage";
    const std::uint32_t connection = writer.add_connection(transforms ? "/tf" : "/" + type, type);
    for (int i = 0; i < 3; ++i) writer.write(connection, Timestamp{++t * 1'000'000}, bytes);
  }
  writer.finish();
  std::ostringstream text;
  text << std::ifstream(folder.path() / name, std::ios::binary).rdbuf();
  return text.str();
}

/// The first byte selects the reader, see the target.
std::vector<std::string> seeds() {
  std::vector<std::string> all{std::string(1, '\0'), "\1"};
  for (const ChunkCompression method :
       {ChunkCompression::kNone, ChunkCompression::kBz2, ChunkCompression::kLz4})
    all.push_back('\0' + small_bag("a.bag", method));
  for (const ChunkCompression method :
       {ChunkCompression::kNone, ChunkCompression::kLz4, ChunkCompression::kZstd})
    all.push_back('\1' + small_bag("a.mcap", method));
  for (const auto& [type, bytes] : small_messages(WireFormat::kRos1)) all.push_back('\2' + bytes);
  for (const auto& [type, bytes] : small_messages(WireFormat::kCdr)) all.push_back('\3' + bytes);
  return all;
}

/// One to four mutations: a changed byte, a number at a limit, a removed or duplicated part, a shortened end.
std::string mutated(std::string bytes, std::mt19937& random) {
  const auto below = [&random](std::size_t n) { return n == 0 ? 0 : random() % n; };
  for (std::size_t count = 1 + below(4); count > 0 && bytes.size() > 9; --count) {
    const std::size_t at = 1 + below(bytes.size() - 9);
    const std::size_t length = below(std::min<std::size_t>(bytes.size() - at, 40));
    switch (below(5)) {
      case 0:
        bytes[at] = static_cast<char>(below(256));
        break;
      case 1:
        bytes.replace(at, 4, below(2) == 0 ? std::string(4, '\xff') : std::string(4, '\0'));
        break;
      case 2:
        bytes.erase(at, length);
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, length));
        break;
      default:
        bytes.resize(bytes.size() - below(bytes.size() / 4));
        break;
    }
  }
  return bytes;
}

TEST(BagReaders, SeedsAreReadOrRejected) {
  for (const std::string& seed : seeds()) EXPECT_EQ(run_target(seed), 0);
}

/// STILLPOINT_FUZZ_SECONDS extends the test, e.g. under the address sanitizer.
TEST(BagReaders, MutationsAreReadOrRejected) {
  const std::vector<std::string> all = seeds();
  const char* const seconds = std::getenv("STILLPOINT_FUZZ_SECONDS");
  const auto end =
      std::chrono::steady_clock::now() + std::chrono::seconds(seconds == nullptr ? 0 : std::atoi(seconds));
  std::mt19937 random(7);
  for (int i = 0; i < kMutations || std::chrono::steady_clock::now() < end; ++i)
    ASSERT_EQ(run_target(mutated(all[random() % all.size()], random)), 0);
}

}  // namespace
}  // namespace stillpoint::datasets
