// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "datasets/open_sequence.h"
#include "datasets/sequence_export.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/sequences/small_stream.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

class ExportedBag : public testing::TestWithParam<const char*> {};

TEST_P(ExportedBag, KeepsEveryBitOfTheSequence) {
  const TemporaryFolder folder;
  SmallStream stream;
  stream.info_.rig.imu_noise.gyro_noise = 0.0123;
  stream.info_.rig.time_offset_s = 0.005;
  stream.info_.rig.rolling_shutter_s = 0.02;
  stream.info_.rig.camera.distortion = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8};
  export_bag(stream, folder.path() / GetParam());
  const std::unique_ptr<SensorStream> read = open_sequence(folder.path() / GetParam());
  const SequenceInfo& info = read->info();
  EXPECT_EQ(info.format, "bag");
  EXPECT_EQ(info.frame_times, stream.info().frame_times);
  ASSERT_EQ(info.imu.size(), 3U);
  EXPECT_EQ(info.imu[1].gyro_b, stream.info().imu[1].gyro_b);
  EXPECT_EQ(info.imu[1].accel_b, stream.info().imu[1].accel_b);
  EXPECT_EQ(info.rig.camera.distortion, stream.info().rig.camera.distortion);
  EXPECT_EQ(info.rig.camera.fy, 5.5);
  EXPECT_EQ(info.rig.T_b_c.q.coeffs(), stream.info().rig.T_b_c.q.coeffs());
  EXPECT_EQ(info.rig.T_b_c.p, stream.info().rig.T_b_c.p);
  EXPECT_EQ(info.rig.imu_noise.gyro_noise, 0.0123);
  EXPECT_EQ(info.rig.time_offset_s, 0.005);
  EXPECT_EQ(info.rig.rolling_shutter_s, 0.02);
  EXPECT_EQ(read->load_frame(2).gray.at<std::uint8_t>(0, 0), 20);
  EXPECT_EQ(read->load_frame(2).depth.at<std::uint16_t>(5, 7), 1000);
  ASSERT_EQ(info.ground_truth.trajectory.poses.size(), 3U);
  // The camera is 0.5 m behind the marker, which is at x = 2.
  const Pose T_w_c = info.ground_truth.trajectory.poses[2].T_w_f * info.ground_truth.T_c_f.inverse();
  EXPECT_EQ(T_w_c.p, Eigen::Vector3d(2.0, 0.0, -0.5));
}

INSTANTIATE_TEST_SUITE_P(All, ExportedBag, testing::Values("small.bag", "small.mcap", "small"));

TEST(BagExport, RefusesAnExistingBagAndAnUnknownCompression) {
  const TemporaryFolder folder;
  folder.write("a.bag", "mine");
  expect_input_error([&] { export_bag(SmallStream(), folder.path() / "a.bag"); }, {"a.bag", "exists"});
  expect_input_error([&] { export_bag(SmallStream(), folder.path() / "b.bag", "zip"); },
                     {"zip", "none, bz2"});
  expect_input_error([&] { export_bag(SmallStream(), folder.path() / "b.bag", "zstd"); },
                     {"b.bag", "no such compression"});
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "b.bag"));
}

TEST(BagExport, AnInterruptedExportLeavesNoFile) {
  const TemporaryFolder folder;
  expect_input_error(
      [&] {
        export_bag(SmallStream(), folder.path() / "a.mcap", "lz4",
                   {.progress = {}, .stop_requested = [] { return true; }});
      },
      {"interrupted"});
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace stillpoint::datasets
