// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sequence_export.h"

#include <gtest/gtest.h>

#include "datasets/open_sequence.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/sequences/small_stream.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

/// Expects the camera at the last frame 0.5 m behind the marker, which is at x = 2.
void expect_same_trajectory(const SequenceInfo& info) {
  ASSERT_EQ(info.ground_truth.trajectory.poses.size(), 3u);
  const Pose T_w_c = info.ground_truth.trajectory.poses.back().T_w_f * info.ground_truth.T_c_f.inverse();
  EXPECT_NEAR((T_w_c.p - Eigen::Vector3d(2.0, 0.0, -0.5)).norm(), 0.0, 1e-8);
}

TEST(SequenceExport, TumRoundTripPreservesTheSequence) {
  const TemporaryFolder folder;
  const SmallStream stream;
  export_tum(stream, folder.path() / "out");
  const std::unique_ptr<SensorStream> read = open_sequence(folder.path() / "out");
  EXPECT_EQ(read->info().format, "tum");
  EXPECT_EQ(read->info().frame_times, stream.info().frame_times);
  EXPECT_EQ(read->info().rig.camera.fy, 5.5);
  EXPECT_EQ(read->info().rig.depth_units_per_m, 1000.0);
  ASSERT_EQ(read->info().imu.size(), 3u);
  EXPECT_EQ(read->info().imu[1].gyro_b.z(), 1.0 / 3.0);
  EXPECT_NEAR((read->info().rig.T_b_c.p - stream.info().rig.T_b_c.p).norm(), 0.0, 1e-12);
  EXPECT_EQ(read->load_frame(2).gray.at<std::uint8_t>(0, 0), 20);
  EXPECT_EQ(read->load_frame(2).depth.at<std::uint16_t>(5, 7), 1000);
  expect_same_trajectory(read->info());
}

TEST(SequenceExport, EurocRoundTripPreservesTheSequence) {
  const TemporaryFolder folder;
  const SmallStream stream;
  export_euroc(stream, folder.path() / "out");
  const std::unique_ptr<SensorStream> read = open_sequence(folder.path() / "out");
  EXPECT_EQ(read->info().format, "euroc");
  EXPECT_EQ(read->info().frame_times, stream.info().frame_times);
  EXPECT_EQ(read->info().rig.camera.width, 8);
  EXPECT_NEAR((read->info().rig.T_b_c.p - stream.info().rig.T_b_c.p).norm(), 0.0, 1e-12);
  EXPECT_EQ(read->load_frame(1).gray.at<std::uint8_t>(0, 0), 10);
  expect_same_trajectory(read->info());
}

TEST(SequenceExport, EurocKeepsAllCoefficientsOfTheLens) {
  const TemporaryFolder folder;
  SmallStream stream;
  stream.info_.rig.camera.distortion = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8};
  export_euroc(stream, folder.path() / "out");
  EXPECT_EQ(open_sequence(folder.path() / "out")->info().rig.camera.distortion,
            stream.info_.rig.camera.distortion);
}

TEST(SequenceExport, EveryLayoutKeepsTimeOffsetAndReadoutTime) {
  const TemporaryFolder folder;
  SmallStream stream;
  stream.info_.rig.time_offset_s = 0.0125;
  stream.info_.rig.rolling_shutter_s = 0.02;
  export_tum(stream, folder.path() / "tum");
  export_euroc(stream, folder.path() / "euroc");
  export_bag(stream, folder.path() / "a.bag", "none");
  for (const char* const name : {"tum", "euroc", "a.bag"}) {
    const Rig rig = open_sequence(folder.path() / name)->info().rig;
    EXPECT_EQ(rig.time_offset_s, 0.0125) << name;
    EXPECT_EQ(rig.rolling_shutter_s, 0.02) << name;
  }
}

TEST(SequenceExport, DoesNotReplaceTheFilesOfAnotherBagOfTheName) {
  const TemporaryFolder folder;
  SmallStream stream;
  export_bag(stream, folder.path() / "a.bag");
  export_bag(stream, folder.path() / "a.mcap");  // of the same recording
  std::filesystem::remove(folder.path() / "a.mcap");
  stream.info_.rig.time_offset_s = 0.01;
  expect_input_error([&] { export_bag(stream, folder.path() / "a.mcap"); },
                     {"a.rig.toml", "another bag of this name"});
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.mcap"));
  EXPECT_EQ(open_sequence(folder.path() / "a.bag")->info().rig.time_offset_s, 0.0);
  folder.write("b.detections.txt", "1.0\n");  // without boxes of its own, those would be read
  expect_input_error([&] { export_bag(stream, folder.path() / "b.bag"); }, {"b.detections.txt"});
}

TEST(SequenceExport, EurocRequiresAnImu) {
  const TemporaryFolder folder;
  SmallStream stream;
  stream.info_.imu.clear();
  expect_input_error([&] { export_euroc(stream, folder.path() / "out"); }, {"has no IMU"});
}

TEST(SequenceExport, LeavesNoFilesOnFailure) {
  const TemporaryFolder folder;
  folder.write("file", "no folder");
  expect_input_error([&] { export_tum(SmallStream(), folder.path() / "file" / "out"); },
                     {"cannot be exported"});
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "file" / "out"));
}

}  // namespace
}  // namespace stillpoint::datasets
