// SPDX-License-Identifier: BSD-3-Clause
/// Miniatures of the layouts of Bonn, ETH3D, ICL-NUIM, TUM VI and CID-SIMS.
#include <gtest/gtest.h>

#include "datasets/io/image_io.h"
#include "datasets/open_sequence.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/sequences/sequence_folders.h"

namespace stillpoint::datasets {
namespace {

void write_image(const std::filesystem::path& file, const cv::Mat& image) {
  std::filesystem::create_directories(file.parent_path());
  write_png(file, image);
}

cv::Mat gray(int value) { return {6, 8, CV_8UC1, cv::Scalar(value)}; }
cv::Mat deep(int value) { return {6, 8, CV_16UC1, cv::Scalar(value)}; }

TEST(BonnFormat, ListedImagesThatDoNotExistAreDropped) {
  const TemporaryFolder parent;
  const std::filesystem::path folder = parent.path() / "rgbd_bonn_person_tracking";
  {
    const TemporaryFolder tum;
    write_tum_folder(tum);
    std::filesystem::rename(tum.path(), folder);
  }
  std::filesystem::remove(folder / "rig.toml");
  std::filesystem::remove(folder / "depth/1.045000.png");
  const std::unique_ptr<SensorStream> stream = open_sequence(folder);
  EXPECT_EQ(stream->info().frame_times, (std::vector<Timestamp>{{1'000'000'000}, {1'080'000'000}}));
  EXPECT_EQ(stream->info().rig.camera.fx, 542.822841);
  EXPECT_EQ(stream->info().rig.depth_units_per_m, 5000.0);
  ASSERT_EQ(stream->info().warnings.size(), 1U);
  EXPECT_EQ(stream->info().warnings[0], "images: 1 image of the lists missing and dropped");
}

TEST(Eth3dFormat, CalibrationIsInItsFile) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  std::filesystem::remove(folder.path() / "rig.toml");
  folder.write("calibration.txt", "10.28 10.29 3.6 2.4\n");
  const std::unique_ptr<SensorStream> stream = open_sequence(folder.path());
  EXPECT_EQ(stream->info().format, "eth3d");
  EXPECT_EQ(stream->info().rig.camera.fy, 10.29);
  EXPECT_EQ(stream->info().rig.camera.cx, 3.6);
  EXPECT_EQ(stream->info().rig.camera.width, 8);
  EXPECT_DOUBLE_EQ(depth_at(stream->load_frame(0).depth, 5000.0, 3, 2), 1.0);
  std::filesystem::remove(folder.path() / "depth.txt");
  EXPECT_TRUE(open_sequence(folder.path())->load_frame(2).depth.empty());
  folder.write("calibration.txt", "0 0 0 0\n");
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path())); },
                     {"calibration.txt", "fx fy cx cy"});
}

/// Three images and the list of their frame numbers.
void write_icl_images(const TemporaryFolder& folder) {
  std::string rows;
  for (int i = 0; i < 3; ++i) {
    const std::string number = std::to_string(i);
    write_image(folder.path() / "rgb" / (number + ".png"), cv::Mat(480, 640, CV_8UC3, cv::Scalar(1, 2, 3)));
    write_image(folder.path() / "depth" / (number + ".png"), cv::Mat(480, 640, CV_16UC1, cv::Scalar(10000)));
    rows += number + " depth/" + number + ".png " + number + " rgb/" + number + ".png\n";
  }
  folder.write("associations.txt", rows);
}

TEST(IclNuimFormat, FrameNumbersAreTimesAndTheMirroredAxisIsRestored) {
  const TemporaryFolder folder;
  write_icl_images(folder);
  // 90 degrees about x, then about z: with the y axis mirrored, both turn the other way.
  folder.write("livingRoom0.gt.freiburg",
               "1 1 2 3 0.7071067811865476 0 0 0.7071067811865476\n2 1 2 3 0 0 0.7071067811865476 "
               "0.7071067811865476\n");
  const std::unique_ptr<SensorStream> stream = open_sequence(folder.path());
  const SequenceInfo& info = stream->info();
  EXPECT_EQ(info.format, "icl-nuim");
  EXPECT_EQ(info.frame_times, (std::vector<Timestamp>{{0}, {33'333'333}, {66'666'667}}));
  EXPECT_EQ(info.rig.camera.fy, 480.0);
  EXPECT_DOUBLE_EQ(depth_at(stream->load_frame(1).depth, info.rig.depth_units_per_m, 3, 2), 2.0);
  const std::vector<StampedPose>& poses = info.ground_truth.trajectory.poses;
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].t, info.frame_times[1]);
  const Eigen::Matrix3d F = Eigen::Vector3d(1.0, -1.0, 1.0).asDiagonal();
  const Eigen::Matrix3d about_x = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_TRUE(poses[0].T_w_f.R().isApprox(F * about_x * F, 1e-12));
  EXPECT_TRUE(poses[0].T_w_f.p.isApprox(Eigen::Vector3d(1, -2, 3)));
}

TEST(IclNuimFormat, ThePathTellsTheDepthImageOfAPair) {
  const TemporaryFolder folder;
  write_icl_images(folder);
  folder.write("associations.txt", "0 rgb/0.png 0 depth/0.png\n4 rgb/2.png 3 depth/1.png\n");
  const auto stream = open_sequence(folder.path());
  EXPECT_EQ(stream->info().frame_times[1], Timestamp{133'333'333});  // 4 / 30 s
  EXPECT_EQ(stream->load_frame(1).depth.at<std::uint16_t>(0, 0), 10000);
  EXPECT_EQ(stream->load_frame(1).color.at<cv::Vec3b>(0, 0)[2], 3);
  folder.write("associations.txt", "0 rgb/0.png 0 d/0.png\n");
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path())); },
                     {"associations.txt:1", "contain \"depth\""});
}

TEST(IclNuimFormat, GroundTruthOfAnotherCameraIsNotMirrored) {
  const TemporaryFolder folder;
  write_icl_images(folder);
  folder.write("groundtruth.txt", "1 1 2 3 0 0 0 1\n2 1 2 3 0 0 0 1\n15 1 2 3 0 0 0 1\n");
  const auto y_of_truth = [&](const OpenOptions& options) {
    return open_sequence(folder.path(), options)->info().ground_truth.trajectory.poses.at(0).T_w_f.p.y();
  };
  EXPECT_EQ(y_of_truth({}), -2.0);
  const std::filesystem::path rig = folder.write("other.toml", "[camera]\nfx = 525\nfy = 525\n");
  EXPECT_EQ(y_of_truth({.rig_file = rig}), 2.0);
  folder.write("rig.toml", "[depth]\nscale = 1000\n");  // of the same camera
  EXPECT_EQ(y_of_truth({}), -2.0);
  std::filesystem::rename(rig, folder.path() / "rig.toml");
  EXPECT_EQ(y_of_truth({}), 2.0);
}

TEST(IclNuimFormat, StampsInThePlaceOfFrameNumbersAreErrors) {
  const TemporaryFolder folder;
  write_icl_images(folder);
  folder.write("groundtruth.txt", "0.033 1 2 3 0 0 0 1\n");
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path())); },
                     {"groundtruth.txt", "0.033", "no frame number"});
}

TEST(TumViFormat, DeepImagesAndTheCalibrationOfKalibrAreRead) {
  const TemporaryFolder folder;
  folder.write("mav0/cam0/data.csv",
               "#timestamp [ns],filename\n1000000000,1000000000.png\n1050000000,1050000000.png\n");
  write_image(folder.path() / "mav0/cam0/data/1000000000.png", deep(0x12ff));
  write_image(folder.path() / "mav0/cam0/data/1050000000.png", gray(7));
  std::string samples = "#timestamp [ns],w,w,w,a,a,a\n";
  for (int i = 0; i < 20; ++i) samples += std::to_string(1'000'000'000 + i * 5'000'000) + ",0,0,0,0,0,9.8\n";
  folder.write("mav0/imu0/data.csv", samples);
  folder.write("mav0/mocap0/data.csv",
               "#timestamp [ns], p, p, p, q, q, q, q\n1000000000,1,2,3,1,0,0,0\n1050000000,1,2,3,1,0,0,0\n");
  folder.write(
      "dso/camchain.yaml",
      "cam0:\n  T_cam_imu:\n  - [1.0, 0.0, 0.0, 0.1]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n"
      "  - [0.0, 0.0, 0.0, 1.0]\n  camera_model: pinhole\n  distortion_coeffs: [0.003, 0.0007, -0.002, "
      "0.0002]\n"
      "  distortion_model: equidistant\n  intrinsics: [190.9, 190.8, 4.5, 2.5]\n  resolution: [8, 6]\n"
      "  timeshift_cam_imu: -0.002\n");
  folder.write("dso/imu_config.yaml",
               "accelerometer_noise_density: 0.0028\naccelerometer_random_walk: 0.00086\n"
               "gyroscope_noise_density: 0.00016\ngyroscope_random_walk: 2.2e-05\n");
  const std::unique_ptr<SensorStream> stream = open_sequence(folder.path());
  const SequenceInfo& info = stream->info();
  EXPECT_EQ(info.format, "tum-vi");
  EXPECT_EQ(info.rig.camera.model, CameraModel::kKannalaBrandt);
  EXPECT_EQ(info.rig.camera.distortion[2], -0.002);
  EXPECT_EQ(info.rig.imu_noise.accel_walk, 0.00086);
  EXPECT_NEAR(info.rig.T_b_c.p.x(), -0.1, 1e-15);
  EXPECT_EQ(info.rig.time_offset_s, -0.002);
  EXPECT_EQ(stream->load_frame(0).gray.at<std::uint8_t>(3, 3), 0x12);
  EXPECT_EQ(stream->load_frame(1).gray.at<std::uint8_t>(3, 3), 7);
  EXPECT_TRUE(stream->load_frame(0).depth.empty());
  EXPECT_EQ(info.ground_truth.trajectory.poses.size(), 2U);
}

TEST(CidSimsFormat, NamesAreTimesAndGravityTellsTheOrderOfTheColumns) {
  const TemporaryFolder folder;
  for (const char* stamp : {"10.000000", "10.033000", "10.066000"}) {
    write_image(folder.path() / "color" / (std::string(stamp) + ".png"), gray(5));
    write_image(folder.path() / "depth" / (std::string(stamp) + ".png"), deep(2000));
  }
  std::string samples;
  for (int i = 0; i < 20; ++i) samples += std::to_string(9.99 + 0.005 * i) + " 0 -9.8 0 0.1 0.2 0.3\n";
  folder.write("imu.txt", samples);
  folder.write("pose.txt", "10.0 0 0 0 0 0 0 1\n10.1 1 0 0 0 0 0 1\n");
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path())); }, {"rig.toml", "CID-SIMS"});
  folder.write("rig.toml",
               "camera = { width = 8, height = 6, fx = 5, fy = 5, cx = 4, cy = 3 }\n"
               "imu = { T_b_c = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1] }\n");
  const std::unique_ptr<SensorStream> stream = open_sequence(folder.path());
  EXPECT_EQ(stream->info().format, "cid-sims");
  EXPECT_EQ(stream->info().frame_times[1].ns, 10'033'000'000);
  EXPECT_EQ(stream->info().imu[2].accel_b, Eigen::Vector3d(0, -9.8, 0));
  EXPECT_EQ(stream->info().imu[2].gyro_b, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(stream->load_frame(0).depth_units_per_m, 1000.0);
  EXPECT_EQ(stream->info().ground_truth.trajectory.poses.size(), 2U);
}

TEST(CidSimsFormat, ColorMayBeJpeg) {
  const TemporaryFolder folder;
  for (const char* stamp : {"10.000000", "10.033000"}) {
    write_image(folder.path() / "color" / (std::string(stamp) + ".png"), gray(5));
    std::filesystem::rename(folder.path() / "color" / (std::string(stamp) + ".png"),
                            folder.path() / "color" / (std::string(stamp) + ".jpg"));
    write_image(folder.path() / "depth" / (std::string(stamp) + ".png"), deep(2000));
  }
  folder.write("pose.txt", "10.0 0 0 0 0 0 0 1\n10.1 1 0 0 0 0 0 1\n");
  folder.write("rig.toml", "camera = { width = 8, height = 6, fx = 5, fy = 5, cx = 4, cy = 3 }\n");
  EXPECT_EQ(open_sequence(folder.path())->info().frame_times.size(), 2U);
}

}  // namespace
}  // namespace stillpoint::datasets
