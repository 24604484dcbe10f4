// SPDX-License-Identifier: BSD-3-Clause
/// Sequences with one fault each: the error is reported on opening, or for the affected frame only.
#include <gtest/gtest.h>

#include "datasets/io/image_io.h"
#include "datasets/open_sequence.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/sequences/sequence_folders.h"

namespace stillpoint::datasets {
namespace {

void expect_rejected(const TemporaryFolder& folder, const std::vector<std::string>& parts) {
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path())); }, parts);
}

void expect_only_frame_rejected(const TemporaryFolder& folder, std::size_t index,
                                const std::vector<std::string>& parts) {
  const auto stream = open_sequence(folder.path());
  expect_input_error([&] { static_cast<void>(stream->load_frame(index)); }, parts);
  EXPECT_NO_THROW(static_cast<void>(stream->load_frame(0)));
}

TEST(BadSequence, AMissingImageAffectsItsFrameOnly) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  std::filesystem::remove(folder.path() / "rgb/1.040000.png");
  expect_only_frame_rejected(folder, 1, {"1.040000.png", "no such image"});
}

TEST(BadSequence, ATruncatedImageAffectsItsFrameOnly) {
  const TemporaryFolder folder;
  write_seven_scenes_folder(folder);
  const auto file = folder.path() / "frame-000002.depth.png";
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  expect_only_frame_rejected(folder, 2, {"frame-000002.depth.png", "truncated"});
}

TEST(BadSequence, DepthOfAnotherSizeAffectsItsFrameOnly) {
  const TemporaryFolder folder;
  write_openloris_folder(folder);
  write_png(folder.path() / "aligned_depth/100.040000.png", cv::Mat(5, 8, CV_16UC1, cv::Scalar(1)));
  expect_only_frame_rejected(folder, 1, {"100.040000.png", "is 8x5", "calibration is for 8x6"});
}

TEST(BadSequence, DepthInThePlaceOfColorIsAnError) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  for (const char* const name : {"1.000000.png", "1.040000.png", "1.080000.png"})
    write_png(folder.path() / "rgb" / name, cv::Mat(6, 8, CV_16UC1, cv::Scalar(9'000)));
  expect_rejected(folder, {"rgb/1.000000.png", "16 bits per channel", "values up to 9000", "depth image"});
  // Brightness uses the whole range.
  write_png(folder.path() / "rgb" / "1.040000.png", cv::Mat(6, 8, CV_16UC1, cv::Scalar(60'000)));
  EXPECT_EQ(open_sequence(folder.path())->load_frame(1).gray.at<std::uint8_t>(3, 3), 60'000 >> 8);
  folder.write("rgb.txt", "1.005 depth/1.005000.png\n1.045 depth/1.045000.png\n");
  expect_rejected(folder, {"depth/1.005000.png", "as color and as depth"});
}

TEST(BadSequence, EmptyAndUnsortedImuFilesAreErrors) {
  const TemporaryFolder folder;
  write_openloris_folder(folder);
  folder.write("d400_gyroscope.txt", "#Time Gx Gy Gz\n");
  expect_rejected(folder, {"d400_gyroscope.txt", "contains no samples"});
  folder.write("d400_gyroscope.txt", "100.0 0 0 0\n99.0 0 0 0\n");
  expect_rejected(folder, {"d400_gyroscope.txt:2", "sort the file"});
  std::filesystem::remove(folder.path() / "d400_gyroscope.txt");
  expect_rejected(folder, {"d400_gyroscope.txt", "cannot be opened"});
}

TEST(BadSequence, NonFiniteRowsAreErrors) {
  const TemporaryFolder folder;
  write_openloris_folder(folder);
  folder.write("d400_accelerometer.txt", "99.9 0 0 0\n100.0 0 nan 0\n");
  expect_rejected(folder, {"d400_accelerometer.txt:2", "\"nan\" is not finite"});
  write_openloris_folder(folder);
  folder.write("groundtruth.txt", "100.0 inf 0 0 0 0 0 1\n");
  expect_rejected(folder, {"groundtruth.txt:1", "\"inf\" is not finite"});
}

TEST(BadSequence, NonUnitQuaternionsAreErrors) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  folder.write("groundtruth.txt", "1.0 0 0 0 0 0 0 0\n");
  expect_rejected(folder, {"groundtruth.txt:1", "quaternion has norm 0"});
}

TEST(BadSequence, NonRigidPosesAreErrors) {
  const TemporaryFolder folder;
  write_seven_scenes_folder(folder);
  folder.write("frame-000001.pose.txt", "0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 1\n");
  expect_rejected(folder, {"frame-000001.pose.txt", "not a rigid transform"});
  folder.write("frame-000001.pose.txt", "1 0 0 0\n");
  expect_rejected(folder, {"frame-000001.pose.txt", "4 numbers, expected 16"});
  folder.write("frame-000001.pose.txt", "nan 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  expect_rejected(folder, {"frame-000001.pose.txt:1", "not finite"});
}

TEST(BadSequence, NoOverlapInTimeIsAnError) {
  const TemporaryFolder folder;
  write_openloris_folder(folder);
  folder.write("groundtruth.txt", "500.0 0 0 0 0 0 0 1\n");
  expect_rejected(folder, {"the ground truth covers 500", "no overlap in time"});
  write_openloris_folder(folder);
  folder.write("d400_gyroscope.txt", "500.0 0 0 0\n501 0 0 0\n");
  folder.write("d400_accelerometer.txt", "500.0 0 0 0\n501 0 0 0\n");
  expect_rejected(folder, {"the IMU covers 500", "no overlap in time"});
  folder.write("d400_accelerometer.txt", "10.0 0 0 0\n11 0 0 0\n");
  expect_rejected(folder, {"no sample lies within the time span of d400_accelerometer.txt"});
}

TEST(BadSequence, DepthWithoutMatchingColorTimesIsAnError) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  folder.write("depth.txt", "7.0 depth/1.005000.png\n");
  expect_rejected(folder, {"depth.txt", "less than 20 ms"});
}

TEST(BadSequence, UnreadableCalibrationIsAnError) {
  const TemporaryFolder folder;
  write_openloris_folder(folder);
  folder.write("sensors.yaml", "d400_color_optical_frame: [1, 2\n");
  expect_rejected(folder, {"sensors.yaml", "not valid YAML"});
  folder.write("sensors.yaml", "something: 1\n");
  expect_rejected(folder, {"sensors.yaml", "\"d400_color_optical_frame\" is missing"});
  std::filesystem::remove(folder.path() / "sensors.yaml");
  expect_rejected(folder, {"sensors.yaml", "cannot be opened"});
}

TEST(BadSequence, InvalidCalibrationIsAnError) {
  const TemporaryFolder folder;
  write_euroc_folder(folder);
  const std::string identity = "T_BS:\n  data: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n";
  const std::string rest = "resolution: [8, 6]\ndistortion_model: radial-tangential\n";
  const auto with = [&](const std::string& text) { folder.write("mav0/cam0/sensor.yaml", text); };
  with(identity + rest + "distortion_coefficients: [0, 0, 0, 0]\nintrinsics: [10, .nan, 3, 2]\n");
  expect_rejected(folder, {"sensor.yaml", "\"intrinsics\" must contain finite numbers"});
  with(identity + rest + "distortion_coefficients: [0, 0, 0, 0]\nintrinsics: [10, 10]\n");
  expect_rejected(folder, {"sensor.yaml", "fx, fy, cx, cy"});
  with("T_BS:\n  data: [1, 2, 3]\n" + rest + "distortion_coefficients: [0]\nintrinsics: [10, 10, 3, 2]\n");
  expect_rejected(folder, {"sensor.yaml", "\"T_BS\" must have 16 numbers"});
  with(identity +
       "resolution: [8, 6]\ndistortion_model: fov\ndistortion_coefficients: [1]\nintrinsics: [1, 1, 1, 1]\n");
  expect_rejected(folder, {"sensor.yaml", "\"fov\" is not supported"});
}

TEST(BadSequence, FocalLengthsRelativeToTheImageAreAnError) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  folder.write("rig.toml",
               "camera = { width = 640, height = 480, fx = 0.535, fy = 0.72, cx = 0.5, cy = 0.5 }\n");
  expect_rejected(folder, {"rig.toml", "0.535", "640 x 480", "times its width"});
  folder.write("rig.toml", "camera = { width = 640, height = 480, fx = 60, fy = 60, cx = 320, cy = 240 }\n");
  EXPECT_EQ(open_sequence(folder.path())->info().rig.camera.fx, 60.0);
}

TEST(BadSequence, ImpossibleCalibrationsAreErrors) {
  const std::string size = "width = 640, height = 480, ";
  const auto imu = [](const std::string& x_m, const std::string& offset_s) {
    return "imu = { T_b_c = [1,0,0," + x_m + ", 0,1,0,0, 0,0,1,0, 0,0,0,1], time_offset_s = " + offset_s +
           " }\n";
  };
  const auto camera = [&](const std::string& rest) { return "camera = { " + size + rest + " }\n"; };
  const std::string valid = "fx = 535, fy = 539, cx = 320, cy = 240";
  const TemporaryFolder folder;
  write_tum_folder(folder);
  for (const auto& [text, parts] : std::vector<std::pair<std::string, std::vector<std::string>>>{
           {camera("fx = 535, fy = 539, cx = 3200, cy = 240"), {"principal point (3200, 240)", "640 x 480"}},
           {camera("fx = 535, fy = 539, cx = 320, cy = 0"), {"principal point (320, 0)"}},
           {camera("fx = 535, fy = 5390, cx = 320, cy = 240"), {"fx = 535 and fy = 5390"}},
           {camera(valid + ", rolling_shutter_s = 33"), {"readout time", "33 s", "in ms"}},
           {camera(valid) + imu("20.3", "0"), {"distance of camera and IMU", "20.3 m", "in mm"}},
           {camera(valid) + imu("0.02", "-5"), {"time offset", "-5 s", "in ms"}},
           {camera(valid) + "depth = { " + size + "fx = 535, fy = 539, cx = 3200, cy = 240, T_c_d = " +
                "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1] }\n",
            {"principal point (3200, 240)"}}}) {
    SCOPED_TRACE(text);
    folder.write("rig.toml", text);
    std::vector<std::string> all{"rig.toml"};
    all.insert(all.end(), parts.begin(), parts.end());
    expect_rejected(folder, all);
  }
  folder.write("rig.toml", camera(valid + ", rolling_shutter_s = 0.05") + imu("1.5", "0.4"));
  EXPECT_EQ(open_sequence(folder.path())->info().rig.time_offset_s, 0.4);
}

TEST(BadSequence, AnImpossibleValueOfARequestedRigFileIsNamedWithThatFile) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  const TemporaryFolder other;
  const std::filesystem::path rig = other.write("other.toml", "[camera]\ncx = 100\n");
  expect_input_error([&] { static_cast<void>(open_sequence(folder.path(), {.rig_file = rig})); },
                     {rig.string(), "principal point (100, 2.5)"});
}

TEST(BadSequence, UnconnectedCoordinateFramesAreAnError) {
  const TemporaryFolder folder;
  write_openloris_folder(folder);
  folder.write("trans_matrix.yaml",
               "trans_matrix:\n  - parent_frame: a\n    child_frame: b\n    matrix:\n"
               "      data: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n");
  expect_rejected(folder, {"trans_matrix.yaml", "no chain of transforms connects"});
}

TEST(BadSequence, MissingCalibrationErrorSuggestsARigFile) {
  const TemporaryFolder folder;
  write_plain_folder(folder);
  folder.write("camera.json", "{}");
  expect_rejected(folder, {"rig.toml", "no JSON file with the intrinsic_matrix", "camera = { width = 640"});
  folder.write("camera.json", R"({"width": 8, "height": 6, "intrinsic_matrix": [10, 0]})");
  expect_rejected(folder, {"camera.json", "expected width, height"});
  folder.write("camera.json",
               R"({"width": 8, "height": 6, "depth_scale": 0, "intrinsic_matrix": [1,0,0,0,1,0,4,3,1]})");
  expect_rejected(folder, {"camera.json", "depth_scale"});
}

TEST(BadSequence, FaultyRecordedBoxesAreAnError) {
  const TemporaryFolder folder;
  write_tum_folder(folder);
  folder.write("detections.txt", "1.0 person 0.9 30 20 10 40\n");
  expect_rejected(folder, {"detections.txt:1", "inverted"});
}

}  // namespace
}  // namespace stillpoint::datasets
