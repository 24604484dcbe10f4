// SPDX-License-Identifier: BSD-3-Clause
// Bags as those of VCU-RVI: accelerations in g with inverted sign, and neither CameraInfo nor transforms.
#include <gtest/gtest.h>

#include "datasets/bags/bag_file.h"
#include "datasets/bags/messages.h"
#include "datasets/open_sequence.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

/// Three images and ten samples of a standing camera.
/// @param accel [g]
void write_bag(const std::filesystem::path& path, const Eigen::Vector3d& accel) {
  BagWriter bag(path, ChunkCompression::kNone);
  const std::uint32_t color = bag.add_connection("/cam0/color", "sensor_msgs/Image");
  const std::uint32_t imu = bag.add_connection("/imu", "sensor_msgs/Imu");
  const std::string pixels(8 * 6 * 3, '\1');
  for (int i = 0; i < 10; ++i) {
    const MessageHeader header{.stamp = {1'000'000'000 + 10'000'000 * i}, .frame = ""};
    if (i % 4 == 0) {
      const ImageMessage image{
          .header = header, .height = 6, .width = 8, .encoding = "8UC3", .step = 24, .data = pixels};
      bag.write(color, header.stamp, serialize(image, bag.format()));
    }
    bag.write(imu, header.stamp, serialize(ImuMessage{.header = header, .accel = accel}, bag.format()));
  }
  bag.finish();
}

TEST(VcuRviBag, TheSignOfAccelerationsFollowsFromTheExtrinsicOfTheRigFile) {
  const TemporaryFolder folder;
  write_bag(folder.path() / "a.bag", {0.0, 0.0, -1.0});
  // The z axis of the IMU points up: y of the camera = -z of the IMU.
  folder.write("a.rig.toml",
               "camera = { width = 8, height = 6, fx = 10, fy = 10, cx = 3.5, cy = 2.5 }\n"
               "imu = { T_b_c = [-1,0,0,0, 0,0,-1,0, 0,-1,0,0, 0,0,0,1] }\n");
  const SequenceInfo info = open_sequence(folder.path() / "a.bag")->info();
  EXPECT_EQ(info.imu[3].accel_b, Eigen::Vector3d(0.0, 0.0, 9.80665));
}

}  // namespace
}  // namespace stillpoint::datasets
