// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "datasets/io/image_io.h"
#include "datasets/read_sequence.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/sequences/sequence_folders.h"
#include "tests/support/test_data.h"

namespace stillpoint::datasets {
namespace {

bool has_note(const SequenceInfo& info, const std::string& part) {
  return std::any_of(info.notes.begin(), info.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

/// A TUM folder whose name ends with the name of a benchmark sequence, without a rig file.
SequenceInfo tum_info(const std::string& name) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  std::filesystem::remove(folder.path() / "rig.toml");
  const std::filesystem::path named = folder.path().string() + "-" + name;
  std::filesystem::rename(folder.path(), named);
  const SequenceInfo info = open_sequence(named)->info();
  std::filesystem::remove_all(named);
  return info;
}

TEST(TumFormat, PairsImagesAndUsesColorTimestamps) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  const auto stream = open_sequence(folder.path());
  const SequenceInfo& info = stream->info();
  EXPECT_EQ(info.format, "tum");
  EXPECT_EQ(info.name, folder.path().filename());
  EXPECT_EQ(info.frame_times, (std::vector<Timestamp>{{1'000'000'000}, {1'040'000'000}, {1'080'000'000}}));
  EXPECT_EQ(info.rig.depth_units_per_m, 5000.0);
  EXPECT_FALSE(info.rig.has_imu);
  const Frame frame = stream->load_frame(1);
  EXPECT_EQ(frame.id, 1);
  EXPECT_EQ(frame.t, info.frame_times[1]);
  EXPECT_EQ(frame.gray.at<std::uint8_t>(5, 7), 76);  // pure red: 0.299 * 255
  EXPECT_EQ(frame.color.at<cv::Vec3b>(5, 7), cv::Vec3b(255, 0, 0));
  EXPECT_DOUBLE_EQ(depth_at(frame.depth, frame.depth_units_per_m, 3, 2), 1.0);  // 5000 / 5000
}

TEST(TumFormat, ReadsTheListOfAssociatePyInAnyOrderIfThereAreNoOthers) {
  for (const bool depth_first : {false, true}) {
    const TemporaryFolder folder;
    write_tum_folder(folder);
    std::string rows;
    for (const char* stamp : {"1.000000", "1.040000", "1.080000"}) {
      const std::string color = std::string(stamp) + " rgb/" + stamp + ".png";
      const std::string depth = std::string(stamp) + "5 depth/" + stamp + ".png";
      rows += (depth_first ? depth + " " + color : color + " " + depth) + "\n";
    }
    folder.write("associations.txt", rows);
    std::filesystem::remove(folder.path() / "rgb.txt");
    std::filesystem::remove(folder.path() / "depth.txt");
    FaultLog strict;
    const SequenceContent content = read_sequence(folder.path(), {}, strict);
    EXPECT_EQ(content.info.format, "tum");
    EXPECT_EQ(content.info.frame_times,
              (std::vector<Timestamp>{{1'000'000'000}, {1'040'000'000}, {1'080'000'000}}));
    EXPECT_EQ(content.frame_files[1].color.parent_path().filename(), "rgb");
    EXPECT_EQ(content.frame_files[1].depth.parent_path().filename(), "depth");
  }
}

TEST(TumFormat, PairsOfAssociatePyThatAreFarApartAreDropped) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  std::filesystem::remove(folder.path() / "rgb.txt");
  const std::string late = "1.0 rgb/1.000000.png 1.045 depth/1.045000.png\n";
  folder.write("associations.txt", late + "1.04 rgb/1.040000.png 1.045 depth/1.045000.png\n");
  const SequenceInfo info = open_sequence(folder.path())->info();
  EXPECT_EQ(info.frame_times, (std::vector<Timestamp>{{1'040'000'000}}));
  EXPECT_TRUE(has_note(info, "1 of 2 color images have no depth image less than 20 ms away"));
  folder.write("associations.txt", late);
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path())); },
                     {"associations.txt", "less than 20 ms", "pair the images again"});
}

TEST(TumFormat, GroundTruthIsOfTheCamera) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  const auto stream = open_sequence(folder.path());
  const GroundTruth& truth = stream->info().ground_truth;
  EXPECT_EQ(truth.trajectory.frame, "camera");
  ASSERT_EQ(truth.trajectory.poses.size(), 31U);
  EXPECT_TRUE(truth.trajectory.poses[30].T_w_f.p.isApprox(Eigen::Vector3d(0.3, 0, 0)));
  EXPECT_TRUE(truth.T_c_f.matrix().isIdentity());
}

TEST(TumFormat, SelectsThePublishedCalibrationByName) {
  EXPECT_EQ(tum_info("rgbd_dataset_freiburg1_xyz").rig.camera.fx, 517.3);
  EXPECT_EQ(tum_info("rgbd_dataset_freiburg2_desk").rig.camera.distortion[1], -0.7849);
  EXPECT_EQ(tum_info("rgbd_dataset_freiburg3_walking_xyz").rig.camera.fy, 539.2);
}

TEST(TumFormat, AnUnknownCameraIsAnErrorWithARigFileToPaste) {
  const std::string rig =
      "camera = { width = 640, height = 480, fx = 535.4, fy = 539.2, cx = 320.1, cy = 247.6 }";
  expect_input_error([] { static_cast<void>(tum_info("mine")); },
                     {"-mine/rig.toml", "none of freiburg1, freiburg2, freiburg3", "freiburg3: " + rig});
  const TemporaryFolder folder;
  write_tum_folder(folder);
  folder.write("rig.toml", rig + "\n");
  EXPECT_EQ(open_sequence(folder.path())->info().rig.camera.cy, 247.6);
}

TEST(TumFormat, DropsColorImagesWithoutDepthAndNotesTheirNumber) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  folder.write("depth.txt",
               "1.005 depth/1.005000.png\n1.0605 depth/1.045000.png\n1.085 depth/1.085000.png\n");
  const auto stream = open_sequence(folder.path());
  EXPECT_EQ(stream->info().frame_times.size(), 2U);  // 1.0605 is 20.5 ms from 1.04 and 19.5 ms from 1.08
  EXPECT_TRUE(has_note(stream->info(), "1 of 3 color images"));
}

TEST(TumFormat, ReadsAnImuIfTheRigFileHasTheExtrinsic) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  folder.write("imu.txt", "0.9 1 2 3 4 5 6\n1.2 1 2 3 4 5 6\n");
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path())); }, {"T_b_c"});
  const auto rig =
      folder.write("other.toml",
                   "[camera]\nwidth = 8\nheight = 6\nfx = 10\nfy = 10\ncx = 3.5\ncy = 2.5\n[imu]\n"
                   "T_b_c = [1,0,0,0.5, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n");
  const auto stream = open_sequence(folder.path(), {.format = "tum", .rig_file = rig});
  EXPECT_TRUE(stream->info().rig.has_imu);
  EXPECT_EQ(stream->info().rig.T_b_c.p.x(), 0.5);
  ASSERT_EQ(stream->info().imu.size(), 2U);
  EXPECT_EQ(stream->info().imu[0].t, Timestamp{900'000'000});
  EXPECT_EQ(stream->info().imu[0].accel_b, Eigen::Vector3d(4, 5, 6));
}

TEST(TumFormat, TheAxesOfARigFileCorrectTheSamplesOnce) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  folder.write("imu.txt", "0.9 1 2 3 4 5 6\n1.2 1 2 3 4 5 6\n");
  const std::string rig =
      "[camera]\nwidth = 8\nheight = 6\nfx = 10\nfy = 10\ncx = 3.5\ncy = 2.5\n[imu]\n"
      "T_b_c = [1,0,0,0.5, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n";
  folder.write("rig.toml",
               rig + "gyro_axes = [1.1,0,0, 0,1,0, 0,0,1]\naccel_axes = [1,0,0.1, 0,1,0, 0,0,1.2]\n");
  const auto first = [&](const std::filesystem::path& file) {
    return open_sequence(folder.path(), {.format = "tum", .rig_file = file})->info().imu.front();
  };
  EXPECT_TRUE(first({}).gyro_b.isApprox(Eigen::Vector3d(1.0 / 1.1, 2.0, 3.0)));
  EXPECT_TRUE(first({}).accel_b.isApprox(Eigen::Vector3d(3.5, 5.0, 5.0)));
  // A file that is requested replaces the axes of the folder; identities keep the bits.
  const auto exact = folder.write("exact.toml", rig + "gyro_axes = [1,0,0, 0,1,0, 0,0,1]\n");
  EXPECT_EQ(first(exact).gyro_b, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(first(exact).accel_b.isApprox(Eigen::Vector3d(3.5, 5.0, 5.0)));
}

TEST(TumFormat, TheOffsetOfTheRigFileCorrectsDepthImages) {
  const TemporaryFolder folder;
  write_tum_folder(folder, 8, 6);
  const std::string rig = "[camera]\nwidth = 8\nheight = 6\nfx = 10\nfy = 10\ncx = 3.5\ncy = 2.5\n[depth]\n";
  const auto depth = [&](const std::string& offset) {
    folder.write("rig.toml", rig + offset);
    const Frame frame = open_sequence(folder.path())->load_frame(0);
    return depth_at(frame.depth, frame.depth_units_per_m, 3, 2);
  };
  const double measured = depth("");
  EXPECT_NEAR(depth("offset = 0.1\n"), 1.0 / (1.0 / measured - 0.1), 1e-3);
  EXPECT_NEAR(depth("offset = -0.1\n"), 1.0 / (1.0 / measured + 0.1), 1e-3);
}

/// Depth images of 4x3 beside color images of 8x6 with twice the focal length.
TEST(TumFormat, RegistersDepthOfAnotherCameraIfTheRigFileHasThatCamera) {
  const TemporaryFolder folder;
  write_tum_folder(folder, 4, 3);
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path())->load_frame(0)); },
                     {"is 4x3", "[depth] in rig.toml", "T_c_d"});
  folder.write("rig.toml",
               "[camera]\nwidth = 8\nheight = 6\nfx = 10\nfy = 10\ncx = 3.5\ncy = 2.5\n"
               "[depth]\nwidth = 4\nheight = 3\nfx = 5\nfy = 5\ncx = 1.5\ncy = 1\n"
               "T_c_d = [1,0,0,0, 0,1,0,0, 0,0,1,0.5, 0,0,0,1]\n");
  const auto stream = open_sequence(folder.path());
  EXPECT_TRUE(has_note(stream->info(), "depth is registered"));
  const Frame frame = stream->load_frame(0);
  ASSERT_EQ(frame.depth.size(), cv::Size(8, 6));
  EXPECT_DOUBLE_EQ(depth_at(frame.depth, frame.depth_units_per_m, 3, 2), 1.5);
}

TEST(OpenLorisFormat, ReadsCalibrationAndChainsTheTransforms) {
  const TemporaryFolder folder;
  write_openloris_folder(folder);
  const auto stream = open_sequence(folder.path());
  const SequenceInfo& info = stream->info();
  EXPECT_EQ(info.format, "openloris");
  EXPECT_EQ(info.rig.camera.fx, 10.0);  // the file's order is fx, cx, fy, cy
  EXPECT_EQ(info.rig.camera.cx, 3.5);
  EXPECT_EQ(info.rig.camera.fy, 11.0);
  EXPECT_EQ(info.rig.camera.distortion[0], 0.1);
  EXPECT_NEAR(info.rig.T_b_c.p.x(), -0.1, 1e-12);            // the IMU is 0.1 m right of the camera
  EXPECT_NEAR(info.rig.imu_noise.gyro_noise, 2e-3, 1e-12);   // sqrt(4e-6)
  EXPECT_NEAR(info.rig.imu_noise.accel_noise, 3e-2, 1e-12);  // sqrt(9e-4)
  EXPECT_NEAR(info.rig.imu_noise.gyro_walk, 1e-5, 1e-15);
  EXPECT_NEAR(info.rig.imu_noise.accel_walk, 2e-4, 1e-12);
  EXPECT_EQ(info.ground_truth.trajectory.frame, "base_link");
  EXPECT_NEAR(info.ground_truth.T_c_f.p.y(), 1.0, 1e-12);  // base_link below the camera, y points down
  EXPECT_EQ(stream->load_frame(2).depth.at<std::uint16_t>(0, 0), 1000);
}

TEST(OpenLorisFormat, InterpolatesAccelerationAtGyroscopeTimes) {
  const TemporaryFolder folder;
  write_openloris_folder(folder);
  const auto stream = open_sequence(folder.path());
  const std::vector<ImuSample>& imu = stream->info().imu;
  ASSERT_EQ(imu.size(), 121U);           // 400 Hz over 0.3 s, ends included
  for (const ImuSample& sample : imu) {  // both sensors measure the time since 99.9 s
    EXPECT_NEAR(sample.gyro_b.x(), seconds_between(Timestamp{99'900'000'000}, sample.t), 1e-6);
    EXPECT_NEAR(sample.accel_b.z(), sample.gyro_b.z(), 1e-6);
  }
}

TEST(EurocFormat, ReadsLeftCameraImuAndStateEstimate) {
  const TemporaryFolder folder;
  write_euroc_folder(folder);
  const auto stream = open_sequence(folder.path());
  const SequenceInfo& info = stream->info();
  EXPECT_EQ(info.format, "euroc");
  EXPECT_EQ(info.frame_times[1], Timestamp{1'050'000'000});
  EXPECT_EQ(info.rig.camera.fy, 11.0);
  EXPECT_EQ(info.rig.camera.distortion[0], -0.2);
  EXPECT_EQ(info.rig.T_b_c.p.x(), 0.5);
  EXPECT_EQ(info.rig.imu_noise.accel_walk, 4e-3);
  EXPECT_EQ(info.imu.size(), 41U);
  EXPECT_EQ(info.imu[0].gyro_b, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(info.ground_truth.trajectory.poses[40].T_w_f.p.x(), 0.4);
  EXPECT_EQ(info.ground_truth.T_c_f.p.x(), -0.5);
  const Frame frame = stream->load_frame(0);
  EXPECT_EQ(frame.gray.at<std::uint8_t>(0, 0), 7);
  EXPECT_TRUE(frame.color.empty());
  EXPECT_TRUE(frame.depth.empty());
}

TEST(EurocFormat, ReadsGroundTruthBesideMav0IfThereIsNoStateEstimate) {
  const TemporaryFolder folder;
  write_euroc_folder(folder);
  std::filesystem::remove_all(folder.path() / "mav0/state_groundtruth_estimate0");
  folder.write("groundtruth_tum.txt", "1.0 0 0 0 0 0 0 1\n");
  EXPECT_EQ(open_sequence(folder.path())->info().ground_truth.trajectory.poses.size(), 1U);
  EXPECT_EQ(open_sequence(folder.path() / "mav0")->info().ground_truth.trajectory.frame, "imu");
}

TEST(SevenScenesFormat, DerivesTimestampsFromFrameNumbers) {
  const TemporaryFolder folder;
  write_seven_scenes_folder(folder);
  const auto stream = open_sequence(folder.path());
  const SequenceInfo& info = stream->info();
  EXPECT_EQ(info.format, "7scenes");
  EXPECT_EQ(info.frame_times, (std::vector<Timestamp>{{0}, {33'333'333}, {66'666'667}}));
  ASSERT_EQ(info.ground_truth.trajectory.poses.size(), 3U);
  EXPECT_EQ(info.ground_truth.trajectory.poses[2].T_w_f.p.x(), 0.02);
}

TEST(SevenScenesFormat, ReadsTheLargestRawDepthAsNotMeasured) {
  const TemporaryFolder folder;
  write_seven_scenes_folder(folder);
  write_png(folder.path() / "frame-000000.depth.png", cv::Mat(480, 640, CV_16UC1, cv::Scalar(65535)));
  const auto stream = open_sequence(folder.path());
  const cv::Mat depth = stream->load_frame(0).depth;
  EXPECT_EQ(depth.at<std::uint16_t>(240, 320), 0);
}

TEST(SevenScenesFormat, RegistersDepthToTheColorCamera) {
  const TemporaryFolder folder;
  write_seven_scenes_folder(folder);
  const auto stream = open_sequence(folder.path());
  const SequenceInfo& info = stream->info();
  EXPECT_NEAR(info.rig.camera.fx, 527.5, 1e-9);
  EXPECT_NEAR(info.ground_truth.T_c_f.p.x(), -0.023, 1e-9);  // the poses are of the depth camera
  const cv::Mat depth = stream->load_frame(0).depth;
  // The depth image of a plane at 1 m extends 320 / 585 m to either side; in the color camera, 23 mm beside
  // and rotated by 8.3 mrad, its borders are at x/z = 0.534 and -0.559, i.e. at the columns 315 + 527.5 x/z =
  // 597 and 20, and two pixels further inside with distortion.
  EXPECT_NEAR(depth.at<std::uint16_t>(240, 320), 1000, 1);
  EXPECT_GT(depth.at<std::uint16_t>(240, 585), 0);
  EXPECT_EQ(depth.at<std::uint16_t>(240, 600), 0);
  EXPECT_GT(depth.at<std::uint16_t>(240, 32), 0);
  EXPECT_EQ(depth.at<std::uint16_t>(240, 15), 0);
}

TEST(FolderFormat, PairsImagesByNameAndReadsTheJsonCamera) {
  const TemporaryFolder folder;
  write_plain_folder(folder);
  const auto stream = open_sequence(folder.path());
  const SequenceInfo& info = stream->info();
  EXPECT_EQ(info.format, "folder");
  EXPECT_EQ(info.frame_times[0], Timestamp{233'333'333});  // 7 / 30 s
  EXPECT_EQ(info.rig.camera.fy, 11.0);
  EXPECT_EQ(info.rig.camera.cx, 3.5);
  EXPECT_EQ(stream->load_frame(2).depth.at<std::uint16_t>(0, 0), 1000);
}

TEST(FolderFormat, ReadsARowMajorCameraMatrix) {
  const TemporaryFolder folder;
  write_plain_folder(folder);
  folder.write("camera.json",
               R"({"width": 8, "height": 6, "intrinsic_matrix": [10, 0, 3.5, 0, 11, 2.5, 0, 0, 1]})");
  const Camera camera = open_sequence(folder.path())->info().rig.camera;
  EXPECT_EQ(camera.fy, 11.0);
  EXPECT_EQ(camera.cx, 3.5);
  EXPECT_EQ(camera.cy, 2.5);
}

TEST(FolderFormat, ReadsUnitOfDepthAndFrameRateOfARealSense) {
  const TemporaryFolder folder;
  write_plain_folder(folder);
  folder.write("camera.json",
               R"({"width": 8, "height": 6, "intrinsic_matrix": [10, 0, 0, 0, 11, 0, 3.5, 2.5, 1],
                                  "depth_scale": 4000.0001220703125, "fps": 60})");
  const auto stream = open_sequence(folder.path());
  const SequenceInfo& info = stream->info();
  EXPECT_NEAR(info.rig.depth_units_per_m, 4000.0, 1e-3);
  EXPECT_EQ(info.frame_times[0], Timestamp{116'666'667});  // 7 / 60 s
  EXPECT_EQ(stream->load_frame(2).depth.at<std::uint16_t>(0, 0), 1000);
  EXPECT_TRUE(has_note(info, "4000 raw units per meter"));
  EXPECT_TRUE(has_note(info, "file number / 60 s"));
  folder.write("camera.json",
               R"({"width": 8, "height": 6, "intrinsic_matrix": [10, 0, 0, 0, 11, 0, 3.5, 2.5, 1],
                                  "depth_scale": 0.001})");
  EXPECT_EQ(open_sequence(folder.path())->info().rig.depth_units_per_m, 1000.0);
}

TEST(FolderFormat, FindsTheCameraAmongOtherJsonFiles) {
  const TemporaryFolder folder;
  write_plain_folder(folder);
  folder.write("a_config.json", R"({"path_dataset": "/data", "depth_max": 3.0})");
  EXPECT_EQ(open_sequence(folder.path())->info().rig.camera.fy, 11.0);
  folder.write("a_depth.json",
               R"({"width": 8, "height": 6, "intrinsic_matrix": [9, 0, 0, 0, 9, 0, 3.5, 2.5, 1]})");
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path())); },
                     {"camera.json", "another intrinsic_matrix than a_depth.json", "move"});
}

/// Three images color/NAME.png and depth/NAME.png with the depths 1, 2 and 3 m.
void write_named_folder(const TemporaryFolder& folder, const std::vector<std::string>& names) {
  write_plain_folder(folder);
  for (const char* images : {"color", "depth"}) {
    std::filesystem::remove_all(folder.path() / images);
    std::filesystem::create_directory(folder.path() / images);
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    write_png(folder.path() / "color" / (names[i] + ".png"), cv::Mat::zeros(6, 8, CV_8UC3));
    write_png(folder.path() / "depth" / (names[i] + ".png"),
              cv::Mat(6, 8, CV_16UC1, cv::Scalar(1000.0 * static_cast<double>(i + 1))));
  }
}

TEST(FolderFormat, OrdersNamesByTheirNumbersAndTakesTimesFromThem) {
  struct Case {
    std::vector<std::string> names;  // in order of time
    std::vector<std::int64_t> times_ns;
  };
  for (const auto& [names, times_ns] :
       {Case{{"2", "9", "10"}, {66'666'667, 300'000'000, 333'333'333}},
        {{"frame_2", "frame_9", "frame_10"}, {66'666'667, 300'000'000, 333'333'333}},
        {{"1700000000.050000", "1700000000.1", "1700000000.150000"},
         {1700000000'050'000'000, 1700000000'100'000'000, 1700000000'150'000'000}},
        {{"1700000000050000000", "1700000000100000000", "1700000000150000000"},
         {1700000000'050'000'000, 1700000000'100'000'000, 1700000000'150'000'000}},
        {{"1700000000050", "1700000000100", "1700000000150"},
         {1700000000'050'000'000, 1700000000'100'000'000, 1700000000'150'000'000}},
        {{"a", "b", "c"}, {0, 33'333'333, 66'666'667}},
        {{"9_383", "10_417", "11_450"}, {0, 33'333'333, 66'666'667}},
        {{"rgb_1700000000050000000", "rgb_1700000000100000000", "rgb_1700000000150000000"},
         {1700000000'050'000'000, 1700000000'100'000'000, 1700000000'150'000'000}},
        {{"frame_1700000000050000.aligned", "frame_1700000000100000.aligned",
          "frame_1700000000150000.aligned"},
         {1700000000'050'000'000, 1700000000'100'000'000, 1700000000'150'000'000}},
        {{"9_1700000000.05", "10_1700000000.10", "11_1700000000.15"},
         {1700000000'050'000'000, 1700000000'100'000'000, 1700000000'150'000'000}},
        {{"1700000000050_9", "1700000000050_10", "1700000000050_11"},  // the time of the recording
         {300'000'000, 333'333'333, 366'666'667}},
        {{"frame9.aligned", "frame10.aligned", "frame11.aligned"}, {300'000'000, 333'333'333, 366'666'667}},
        {{"0", "0.033", "0.067"}, {0, 33'000'000, 67'000'000}},
        {{"a_9", "a_10", "b_2"}, {0, 33'333'333, 66'666'667}}}) {
    const TemporaryFolder folder;
    write_named_folder(folder, names);
    const auto stream = open_sequence(folder.path());
    SCOPED_TRACE(names.front());
    ASSERT_EQ(stream->info().frame_times.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(stream->info().frame_times[i].ns, times_ns[i]);
      EXPECT_EQ(stream->load_frame(i).depth.at<std::uint16_t>(0, 0), 1000 * (i + 1));
    }
  }
}

TEST(FolderFormat, NumbersThatAreNeitherTimesNorThoseOfFramesAreErrors) {
  for (const std::vector<std::string>& names : std::vector<std::vector<std::string>>{
           {"0", "33333", "66667"},                                                      // us
           {"0", "33333333", "66666667"},                                                // ns
           {"0", "33", "67"},                                                            // ms
           {"cap_20240131120000000", "cap_20240131120000033", "cap_20240131120000066"},  // dates
           {"20240131120000", "20240131120001", "20240131120002"},
           {"99999999999999999999", "100000000000000000000", "100000000000000000001"}}) {  // 2^63 is less
    SCOPED_TRACE(names.front());
    const TemporaryFolder folder;
    write_named_folder(folder, names);
    expect_input_error([&] { static_cast<void>(open_sequence(folder.path())); },
                       {"color", "neither frame numbers at 30 Hz nor times since 1970", "rename the images"});
  }
}

TEST(SevenScenesFormat, NumbersThatAreTimesAreAnError) {
  const TemporaryFolder folder;
  for (const char* number : {"1700000000050000000", "1700000000083333000"})
    write_png(folder.path() / (std::string("frame-") + number + ".color.png"), cv::Mat::zeros(6, 8, CV_8UC3));
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path())); },
                     {folder.path().string(), "up to 1700000000083333000", "frame numbers at 30 Hz"});
}

TEST(FolderFormat, HiddenFilesAreNoImagesAndNoCameras) {
  const TemporaryFolder folder;
  write_named_folder(folder, {"2", "9", "10"});
  folder.write("color/._9.png", "resource fork");
  folder.write("._camera.json", "resource fork");
  const SequenceInfo info = open_sequence(folder.path())->info();
  EXPECT_EQ(info.frame_times, (std::vector<Timestamp>{{66'666'667}, {300'000'000}, {333'333'333}}));
  EXPECT_EQ(info.rig.camera.fy, 11.0);
}

TEST(FolderFormat, ReadsInertialSamplesAndGroundTruthIfTheNamesAreTimes) {
  const TemporaryFolder folder;
  write_named_folder(folder, {"1700000000.05", "1700000000.10", "1700000000.15"});
  folder.write("imu.txt", "1700000000.04 0 0 0 0 -9.8 0\n1700000000.16 0 0 0 0 -9.8 0\n");
  folder.write("groundtruth.txt", "1700000000.04 0 0 0 0 0 0 1\n1700000000.16 1 0 0 0 0 0 1\n");
  folder.write("rig.toml", "imu = { T_b_c = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1] }\n");
  const auto stream = open_sequence(folder.path());
  EXPECT_EQ(stream->info().imu.size(), 2U);
  EXPECT_EQ(stream->info().ground_truth.trajectory.poses.size(), 2U);
  const TemporaryFolder numbered;
  write_named_folder(numbered, {"1", "2", "3"});
  numbered.write("imu.txt", "1700000000.04 0 0 0 0 -9.8 0\n");
  EXPECT_TRUE(
      has_note(open_sequence(numbered.path())->info(), "not read: the names of the images are no times"));
}

TEST(OpenSequence, ErrorsNameCompressedFilesPointersAndOtherFiles) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& name, const std::string& content, const std::string& part) {
    const auto file = folder.write(name, content);
    expect_input_error([&] { static_cast<void>(open_sequence(file)); }, {name, part});
  };
  expect("a_0.db3.zstd", "\x28\xb5\x2f\xfd", "zstd -d");
  expect("a.tar", "a", "extract it");
  expect("a.txt", "a", "is a file, but no bag");
  write_tum_folder(folder);
  folder.write("rgb.txt", "version https://git-lfs.github.com/spec/v1\noid sha256:0\n");
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path())); }, {"rgb.txt", "git lfs pull"});
}

TEST(OpenSequence, UnknownFormatErrorListsTheSupportedFormats) {
  const TemporaryFolder folder;
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path())); },
                     {"not a sequence of a supported format", "rgb.txt", "mav0"});
  expect_input_error(
      [&] { static_cast<void>(open_sequence(folder.path(), {.format = "kitti", .rig_file = {}})); },
      {"kitti", sequence_format_names()});
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path() / "absent")); }, {"no such folder"});
}

TEST(RealData, EveryAvailableFolderOpensAndDecodes) {
  const std::array<std::pair<const char*, const char*>, 3> folders{
      {{"kitchen_rgbd", "7scenes"}, {"two_people_d435", "folder"}, {"euroc_v101_micro", "euroc"}}};
  const std::array<std::size_t, 3> frames{400, 40, 95};
  for (std::size_t i = 0; i < folders.size(); ++i) {
    const auto folder = find_test_data(folders[i].first);
    if (!folder) GTEST_SKIP() << missing_test_data(folders[i].first);
    const auto stream = open_sequence(*folder);
    EXPECT_EQ(stream->info().format, folders[i].second);
    ASSERT_EQ(stream->info().frame_times.size(), frames[i]);
    EXPECT_EQ(stream->load_frame(frames[i] - 1).gray.cols, stream->info().rig.camera.width);
  }
}

TEST(RealData, TheOpenLorisExampleHasTheD435iExtrinsic) {
  const auto folder = find_test_data("openloris/package_example");
  if (!folder) GTEST_SKIP() << missing_test_data("openloris/package_example");
  FaultLog faults(FaultLog::Mode::kCollect);
  const SequenceContent content = read_sequence(*folder, {}, faults);
  // Inverse of the pose of the gyroscope in the camera frame given by the file: -R^T t.
  EXPECT_TRUE(content.info.rig.T_b_c.p.isApprox(Eigen::Vector3d(0.02030, -0.00510, -0.01120), 1e-2));
  EXPECT_NEAR(content.info.rig.imu_noise.gyro_noise, 1.8e-4, 1e-9);  // sqrt(3.24e-8)
  EXPECT_EQ(content.info.frame_times.size(), 5U);
  EXPECT_EQ(content.info.imu.size(), 3U);   // the first of the four lies before the accelerometer's first
  ASSERT_EQ(faults.messages().size(), 2U);  // an excerpt: neither IMU nor ground truth overlaps the images
  EXPECT_NE(faults.messages()[0].find("the IMU covers"), std::string::npos);
  EXPECT_NE(faults.messages()[1].find("the ground truth covers"), std::string::npos);
}

}  // namespace
}  // namespace stillpoint::datasets
