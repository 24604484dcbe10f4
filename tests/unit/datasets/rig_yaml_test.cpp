// SPDX-License-Identifier: BSD-3-Clause
/// Calibrations of other programs, given as a rig file.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "datasets/calibration/rig_file.h"
#include "datasets/calibration/rig_yaml_text.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

OverriddenRig rig_of(const std::string& text, const std::string& name = "rig.yaml", const Rig& known = {}) {
  const TemporaryFolder folder;
  return apply_rig_file(folder.write(name, text), known);
}

void expect_refused(const std::string& text, const std::vector<std::string>& parts) {
  expect_input_error([&] { static_cast<void>(rig_of(text)); }, parts);
}

/// The camera is 0.1 m in front of the IMU: p_cam = R p_imu + t with t = (0, 0, -0.1) and a turn of 90
/// degrees about z, so that the camera is at -R^T t = (0, 0, 0.1) of the IMU.
const std::string kTransform =
    "  - [0.0, 1.0, 0.0, 0.0]\n  - [-1.0, 0.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, -0.1]\n  - [0.0, 0.0, 0.0, "
    "1.0]\n";
const std::string kKalibrCamera =
    "  camera_model: pinhole\n  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]\n  distortion_model: radtan\n"
    "  intrinsics: [500.0, 501.0, 320.0, 240.0]\n  resolution: [640, 480]\n";
const std::string kKalibrImu =
    "accelerometer_noise_density: 0.02\naccelerometer_random_walk: 0.003\ngyroscope_noise_density: 0.004\n"
    "gyroscope_random_walk: 0.0005\nupdate_rate: 200.0\n";

TEST(RigYaml, ReadsTheChainOfKalibrWithTheDirectionOfItsTransform) {
  const std::string chain = "cam0:\n  T_cam_imu:\n" + kTransform + kKalibrCamera +
                            "  rostopic: /cam0\n  timeshift_cam_imu: -0.0015\n";
  const OverriddenRig read = rig_of(chain);
  EXPECT_TRUE(read.has_extrinsic);
  EXPECT_NEAR((read.rig.T_b_c.p - Eigen::Vector3d(0, 0, 0.1)).norm(), 0.0, 1e-12);
  // The x axis of the camera is the y axis of the IMU: p_imu = R^T (1, 0, 0).
  EXPECT_NEAR((read.rig.T_b_c.R().col(0) - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-12);
  EXPECT_EQ(read.rig.time_offset_s, -0.0015);
  EXPECT_EQ(read.rig.camera.width, 640);
  EXPECT_EQ(read.rig.camera.fy, 501.0);
  EXPECT_EQ(read.rig.camera.model, CameraModel::kRadialTangential);
  EXPECT_EQ(read.rig.camera.distortion[3], 0.4);
  // The name of the file does not matter; the densities may follow in the same file.
  EXPECT_EQ(rig_of(chain + kKalibrImu, "renamed.toml").rig.imu_noise,
            (ImuNoise{.gyro_noise = 0.004, .accel_noise = 0.02, .gyro_walk = 0.0005, .accel_walk = 0.003}));
}

TEST(RigYaml, ReadsAndWritesTheAxesOfKalibr) {
  const std::string accel =
      "accelerometers:\n  M:\n  - [1.01, 0, 0]\n  - [0.002, 0.99, 0]\n  - [0, 0.003, 1]\n";
  const std::string gyro = "gyroscopes:\n  M: [[1.02, 0, 0], [0, 1, 0], [0, 0, 1]]\n";
  const std::string turned = "  C_gyro_i: [[1, 0.01, 0], [-0.01, 1, 0], [0, 0, 1]]\n";
  const ImuAxes axes = rig_of(kKalibrImu + accel + gyro + turned).rig.imu_axes;
  EXPECT_EQ(axes.accel, (Eigen::Matrix3d{{1.01, 0, 0}, {0.002, 0.99, 0}, {0, 0.003, 1}}));
  EXPECT_TRUE(axes.gyro.isApprox(Eigen::Matrix3d{{1.02, 0.0102, 0}, {-0.01, 1, 0}, {0, 0, 1}}));
  expect_refused(kKalibrImu + "gyroscopes:\n  M: [1, 0]\n", {"gyroscopes.M", "9 numbers"});
  expect_refused(kKalibrImu + gyro + "  C_gyro_i: [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]\n",
                 {"gyroscopes.M", "identity"});
  Rig rig;
  rig.camera = {.width = 8, .height = 6, .fx = 5, .fy = 5, .cx = 4, .cy = 3};
  rig.has_imu = true;
  EXPECT_EQ(rig_text(rig, RigFormat::kKalibr).find("gyroscopes"), std::string::npos);
  rig.imu_axes = axes;
  EXPECT_EQ(rig_of(rig_text(rig, RigFormat::kKalibr)).rig.imu_axes, axes);
  EXPECT_NE(rig_text(rig, RigFormat::kVins).find("# not in this format: gyro_axes = [1.02"),
            std::string::npos);
}

TEST(RigYaml, ReadsAndWritesTheAxesOfOpenvins) {
  const std::string accel =
      "Ta:\n  - [1.01, 0, 0]\n  - [0.002, 0.99, 0]\n  - [0, 0.003, 1]\n"
      "R_IMUtoACC: [[1, 0, 0.01], [0, 1, 0], [-0.01, 0, 1]]\n";
  const std::string gyro =
      "Tw: [[1.02, 0, 0], [0, 1, 0], [0, 0, 1]]\nR_IMUtoGYRO: [[1, 0.01, 0], [-0.01, 1, 0], [0, 0, 1]]\n";
  const OverriddenRig read = rig_of(kKalibrImu + accel + gyro + "Tg: [[0, 0, 0], [0, 0, 1e-4], [0, 0, 0]]\n");
  const ImuAxes axes = read.rig.imu_axes;
  // Ta R_IMUtoACC, Tw R_IMUtoGYRO
  EXPECT_TRUE(
      axes.accel.isApprox(Eigen::Matrix3d{{1.01, 0, 0.0101}, {0.002, 0.99, 0.00002}, {-0.01, 0.003, 1}}));
  EXPECT_TRUE(axes.gyro.isApprox(Eigen::Matrix3d{{1.02, 0.0102, 0}, {-0.01, 1, 0}, {0, 0, 1}}));
  EXPECT_NE(std::ranges::find(read.notes, "the influence Tg of accelerations on the gyroscope is not read"),
            read.notes.end());
  expect_refused(kKalibrImu + "Tw: [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]\n", {"Tw", "identity"});
  Rig rig;
  rig.camera = {.width = 8, .height = 6, .fx = 5, .fy = 5, .cx = 4, .cy = 3};
  rig.has_imu = true;
  rig.imu_axes = axes;
  EXPECT_EQ(rig_of(rig_text(rig, RigFormat::kOpenvins)).rig.imu_axes, axes);
}

TEST(RigYaml, ReadsTheInverseTransformOfOpenVinsAndOfEuroc) {
  for (const std::string& key : {std::string("T_imu_cam"), std::string("T_BS")}) {
    const Pose T_b_c = rig_of("cam0:\n  " + key + ":\n" + kTransform + kKalibrCamera).rig.T_b_c;
    EXPECT_NEAR(T_b_c.p.z(), -0.1, 1e-12) << key;
  }
  expect_refused("cam0:\n  T_cam_imu:\n" + kTransform + "  T_imu_cam:\n" + kTransform + kKalibrCamera,
                 {"rig.yaml", "cam0.T_imu_cam", "contradicts"});
}

TEST(RigYaml, KeepsWhatTheFileDoesNotState) {
  Rig known;
  known.camera = {.width = 8, .height = 6, .fx = 5, .fy = 5, .cx = 4, .cy = 3};
  known.depth_units_per_m = 4000.0;
  for (const std::string& text :
       {kKalibrImu,
        "imu0:\n  rostopic: /imu\n  " +
            std::string("gyroscope_noise_density: 0.004\n  accelerometer_noise_density: 0.02\n"
                        "  gyroscope_random_walk: 0.0005\n  accelerometer_random_walk: 0.003\n")}) {
    const OverriddenRig read = rig_of(text, "imu.yaml", known);
    EXPECT_EQ(read.rig.imu_noise.accel_noise, 0.02);
    EXPECT_EQ(read.rig.camera.fx, 5.0);
    EXPECT_EQ(read.rig.depth_units_per_m, 4000.0);
    EXPECT_FALSE(read.has_extrinsic);
  }
}

TEST(RigYaml, ReadsTheMatricesOfOpenCv) {
  const std::string matrix =
      "camera_matrix: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n"
      "  data: [ 500., 0., 320., 0., 501., 240., 0., 0., 1. ]\n";
  const std::string size = "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n";
  const auto with = [&](const std::string& rest) { return rig_of(size + matrix + rest).rig.camera; };
  const Camera pinhole = with("");
  EXPECT_EQ(pinhole.fx, 500.0);
  EXPECT_EQ(pinhole.cy, 240.0);
  EXPECT_EQ(pinhole.height, 480);
  EXPECT_FALSE(pinhole.has_distortion());
  const auto coefficients = [](const std::string& values) {
    return "distortion_coefficients: !!opencv-matrix\n  rows: 1\n  cols: 5\n  dt: d\n  data: [" + values +
           "]\n";
  };
  EXPECT_EQ(with(coefficients("0.1, 0.2, 0.3, 0.4, 0.5")).distortion[4], 0.5);
  EXPECT_EQ(with(coefficients("0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0, 0, 0, 0")).distortion[7], 0.8);
  EXPECT_EQ(with(coefficients("0.1, 0.2, 0.3, 0.4") + "fisheye_model: 1\n").model,
            CameraModel::kKannalaBrandt);
  expect_refused(size + matrix + coefficients("0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0, 0, 0"),
                 {"rig.yaml", "thin prism"});
  expect_refused(matrix, {"rig.yaml", "image_width"});
}

TEST(RigYaml, ReadsCameraInfoOfRosAsFileAndAsMessage) {
  const Camera file =
      rig_of(
          "image_width: 640\nimage_height: 480\ncamera_name: head\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
          "  data: [500, 0, 320, 0, 501, 240, 0, 0, 1]\ndistortion_model: plumb_bob\n"
          "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.1, 0.2, 0, 0, 0.5]\n"
          "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]\n")
          .rig.camera;
  EXPECT_EQ(file.fx, 500.0);
  EXPECT_EQ(file.distortion[4], 0.5);
  const Camera message =
      rig_of(
          "header:\n  stamp: 0\nheight: 720\nwidth: 1280\ndistortion_model: rational_polynomial\n"
          "D: [0.5, -2.6, 0.0009, -4e-05, 1.5, 0.28, -2.4, 1.4]\n"
          "K: [613.0, 0.0, 648.6, 0.0, 612.9, 374.0, 0.0, 0.0, 1.0]\n---\n")
          .rig.camera;
  EXPECT_EQ(message.width, 1280);
  EXPECT_EQ(message.cy, 374.0);
  EXPECT_TRUE(message.has_denominator());
  const Camera fisheye =
      rig_of(
          "height: 480\nwidth: 640\ndistortion_model: equidistant\nd: [0.1, 0.2, 0.3, 0.4]\n"
          "k: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n")
          .rig.camera;
  EXPECT_EQ(fisheye.model, CameraModel::kKannalaBrandt);
}

TEST(RigYaml, ReadsSettingsOfOrbSlam) {
  const std::string camera =
      "%YAML:1.0\n\nCamera.type: \"PinHole\"\nCamera1.fx: 535.0\nCamera1.fy: 536.0\nCamera1.cx: 319.5\n"
      "Camera1.cy: 239.5\nCamera1.k1: 0.1\nCamera1.p2: 0.4\nCamera.width: 640\nCamera.height: 480\n";
  const OverriddenRig read = rig_of(camera +
                                    "RGBD.DepthMapFactor: 5000.0\nIMU.NoiseGyro: 0.001\n"
                                    "IMU.T_b_c1: !!opencv-matrix\n  rows: 4\n  cols: 4\n  dt: f\n"
                                    "  data: [1,0,0,0.1, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n");
  EXPECT_EQ(read.rig.camera.fy, 536.0);
  EXPECT_EQ(read.rig.camera.distortion[0], 0.1);
  EXPECT_EQ(read.rig.camera.distortion[3], 0.4);
  EXPECT_EQ(read.rig.depth_units_per_m, 5000.0);
  EXPECT_EQ(read.rig.imu_noise.gyro_noise, 0.001);
  EXPECT_NEAR(read.rig.T_b_c.p.x(), 0.1, 1e-12);
  expect_refused(
      "Camera.type: \"Omni\"\nCamera.fx: 5\nCamera.fy: 5\nCamera.cx: 5\nCamera.cy: 5\nCamera.width: "
      "9\nCamera.height: 9\n",
      {"rig.yaml", "Camera.type", "Omni", "PinHole"});
}

TEST(RigYaml, ReadsConfigurationsOfVins) {
  const std::string vins =
      "%YAML:1.0\nmodel_type: PINHOLE\nimage_width: 640\nimage_height: 480\nresolution: 0.02\n"
      "distortion_parameters:\n   k1: 0.1\n   k2: 0.2\n   p1: 0.3\n   p2: 0.4\n"
      "projection_parameters:\n   fx: 500\n   fy: 501\n   cx: 320\n   cy: 240\n"
      "extrinsicRotation: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [0,-1,0, 1,0,0, "
      "0,0,1]\n"
      "extrinsicTranslation: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [0.1, 0.2, 0.3]\n"
      "acc_n: 0.08\ntd: 0.005\nrolling_shutter: 0\n";
  const OverriddenRig read = rig_of(vins);
  EXPECT_EQ(read.rig.camera.fy, 501.0);
  EXPECT_EQ(read.rig.camera.distortion[3], 0.4);
  EXPECT_TRUE((read.rig.T_b_c * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0.1, 1.2, 0.3)));
  EXPECT_EQ(read.rig.time_offset_s, 0.005);
  EXPECT_EQ(read.rig.imu_noise, ImuNoise{});  // of a sample, not a density
  const OverriddenRig estimated = rig_of(vins + "estimate_extrinsic: 2\n");
  EXPECT_FALSE(estimated.has_extrinsic);
  EXPECT_EQ(rig_of(vins + "rolling_shutter_tr: 0.03\n").rig.rolling_shutter_s, 0.0);
  expect_refused("model_type: MEI\nprojection_parameters:\n  gamma1: 5\n", {"rig.yaml", "model_type", "MEI"});
}

TEST(RigYaml, ReadsTheFilesThatAConfigurationNames) {
  const TemporaryFolder folder;
  folder.write("imu.yaml",
               "imu0:\n  gyroscope_noise_density: 0.004\n  accelerometer_noise_density: 0.02\n"
               "  gyroscope_random_walk: 0.0005\n  accelerometer_random_walk: 0.003\n");
  folder.write("chain.yaml", "%YAML:1.0\n\ncam0:\n  T_imu_cam:\n" + kTransform + kKalibrCamera);
  const Rig rig =
      apply_rig_file(folder.write("estimator_config.yaml",
                                  "%YAML:1.0\nverbosity: \"INFO\"\nrelative_config_imu: \"imu.yaml\"\n"
                                  "relative_config_imucam: \"chain.yaml\"\n"),
                     Rig{})
          .rig;
  EXPECT_EQ(rig.imu_noise.gyro_noise, 0.004);
  EXPECT_EQ(rig.camera.fx, 500.0);
  EXPECT_NEAR(rig.T_b_c.p.z(), -0.1, 1e-12);
}

TEST(RigYaml, WhatCannotBeReadIsRefusedWithItsKey) {
  expect_refused("cam0:\n  camera_model: omni\n", {"rig.yaml", "cam0.camera_model", "omni", "pinhole"});
  expect_refused(
      "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [0.9]\n  distortion_model: fov\n"
      "  intrinsics: [5, 5, 4, 3]\n  resolution: [8, 6]\n",
      {"rig.yaml", "cam0.distortion_model", "\"fov\"", "radtan"});
  for (const char* width : {"1e12", "320.7", "0"})
    expect_refused(
        "cam0:\n  camera_model: pinhole\n  distortion_model: none\n  distortion_coeffs: []\n"
        "  intrinsics: [5, 5, 4, 3]\n  resolution: [" +
            std::string(width) + ", 6]\n",
        {"\"cam0.resolution\"", "integer from 1 to 65535"});
  expect_refused("cam0:\n  camera_model: pinhole\n  intrinsics: [5, 5, 4]\n  resolution: [8, 6]\n",
                 {"rig.yaml", "cam0.intrinsics", "four numbers"});
  expect_refused(
      "cam0:\n  T_cam_imu: [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n" + kKalibrCamera,
      {"cam0.T_cam_imu", "not a rigid transform"});
  expect_refused("cam1:\n" + kKalibrCamera, {"rig.yaml", "cam0"});
  expect_refused(
      "gyroscope_noise_density: 0\naccelerometer_noise_density: 1\ngyroscope_random_walk: 1\n"
      "accelerometer_random_walk: 1\n",
      {"gyroscope_noise_density", "greater than 0"});
  expect_refused("camera_matrix: [500, 2, 320, 0, 500, 240, 0, 0, 1]\nimage_width: 640\nimage_height: 480\n",
                 {"camera_matrix", "skew"});
  expect_refused("sequence: kitchen\n", {"rig.yaml", "camera_matrix", "rig.toml"});
  expect_refused("cam0: [\n", {"rig.yaml:", "not valid YAML"});
}

Rig rig_with(CameraModel model) {
  Rig rig{.camera = {.width = 848,
                     .height = 480,
                     .fx = 424.1,
                     .fy = 423.9,
                     .cx = 420.3,
                     .cy = 241.7,
                     .model = model,
                     .distortion = {0.05, -0.06, 0.001, -0.002}},
          .depth_units_per_m = 5000.0,
          .has_imu = true};
  rig.T_b_c = {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), Eigen::Vector3d(0.01, -0.02, 0.03)};
  rig.imu_noise = {.gyro_noise = 0.001, .accel_noise = 0.01, .gyro_walk = 1e-5, .accel_walk = 2e-4};
  rig.time_offset_s = 0.0037;
  return rig;
}

TEST(RigYaml, WhatIsWrittenForAProgramIsReadBack) {
  for (const CameraModel model : {CameraModel::kRadialTangential, CameraModel::kKannalaBrandt}) {
    const Rig rig = rig_with(model);
    for (const auto& [format, name] : enum_names(RigFormat{})) {
      const bool is_yaml = format != RigFormat::kStillpoint;
      const OverriddenRig read = rig_of(rig_text(rig, format), is_yaml ? "rig.yaml" : "rig.toml");
      EXPECT_EQ(read.rig.camera.width, rig.camera.width) << name;
      EXPECT_EQ(read.rig.camera.model, model) << name;
      EXPECT_EQ(read.rig.camera.fx, rig.camera.fx) << name;
      EXPECT_EQ(read.rig.camera.cy, rig.camera.cy) << name;
      EXPECT_EQ(read.rig.camera.distortion, rig.camera.distortion) << name;
      if (format == RigFormat::kOpencv) continue;  // the camera alone
      EXPECT_TRUE(read.has_extrinsic) << name;
      EXPECT_TRUE((read.rig.T_b_c.inverse() * rig.T_b_c).matrix().isIdentity(1e-12)) << name;
      const bool has_noise = format != RigFormat::kVins;
      EXPECT_EQ(read.rig.imu_noise, has_noise ? rig.imu_noise : ImuNoise{}) << name;
      const bool has_offset = format != RigFormat::kOrbSlam;
      EXPECT_EQ(read.rig.time_offset_s, has_offset ? rig.time_offset_s : 0.0) << name;
    }
  }
}

TEST(RigYaml, WhatAFormatDoesNotHaveIsACommentOrRefused) {
  Rig rig = rig_with(CameraModel::kRadialTangential);
  rig.rolling_shutter_s = 0.02;
  EXPECT_NE(rig_text(rig, RigFormat::kKalibr).find("# not in this format: rolling_shutter_s = 0.02"),
            std::string::npos);
  rig.camera.distortion[5] = 0.3;  // k4, of the denominator
  EXPECT_EQ(rig_of(rig_text(rig, RigFormat::kOpencv)).rig.camera.distortion, rig.camera.distortion);
  expect_input_error([&] { static_cast<void>(rig_text(rig, RigFormat::kVins)); },
                     {"--out-format vins", "four coefficients", "opencv"});
  expect_input_error([&] { static_cast<void>(rig_text(rig, RigFormat::kOrbSlam)); },
                     {"--out-format orb_slam", "k4 to k6", "opencv"});
}

/// Their parser is OpenCV's, which distinguishes integers from real numbers, and requires that the rows of a
/// matrix are indented more than its key.
TEST(RigYaml, ProgramsThatReadByOpenCvFindNumbersAndMatrices) {
  const TemporaryFolder folder;
  const Rig rig = rig_with(CameraModel::kRadialTangential);
  const auto open = [&](RigFormat format) {
    return cv::FileStorage(folder.write("rig.yaml", rig_text(rig, format)).string(), cv::FileStorage::READ);
  };
  const cv::FileStorage orb_slam = open(RigFormat::kOrbSlam);
  for (const char* const key : {"Camera1.fx", "Camera1.k3", "RGBD.DepthMapFactor", "IMU.GyroWalk"})
    EXPECT_TRUE(orb_slam[key].isReal()) << key;
  EXPECT_EQ(orb_slam["IMU.T_b_c1"].mat().type(), CV_32F);
  EXPECT_EQ(std::string(orb_slam["File.version"]), "1.0");
  const cv::FileStorage openvins = open(RigFormat::kOpenvins);
  EXPECT_EQ(static_cast<double>(openvins["cam0"]["T_imu_cam"][1][3]), rig.T_b_c.p.y());
  for (const char* const key : {"Tw", "R_IMUtoGYRO", "Ta", "R_IMUtoACC"})  // required
    EXPECT_EQ(static_cast<double>(openvins["imu0"][key][2][2]), 1.0) << key;
  EXPECT_EQ(static_cast<double>(openvins["imu0"]["Tg"][2][2]), 0.0);
  EXPECT_EQ(static_cast<double>(open(RigFormat::kVins)["body_T_cam0"].mat().at<double>(2, 3)),
            rig.T_b_c.p.z());
  EXPECT_EQ(open(RigFormat::kOpencv)["camera_matrix"].mat().at<double>(1, 2), rig.camera.cy);
}

}  // namespace
}  // namespace stillpoint::datasets
