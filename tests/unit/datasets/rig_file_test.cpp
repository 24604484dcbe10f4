// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/rig_file.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::datasets {
namespace {

void expect_rejected(const std::string& text, const std::vector<std::string>& parts) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("rig.toml", text);
  expect_input_error([&] { static_cast<void>(apply_rig_file(file, Rig{})); }, parts);
}

constexpr const char* kEveryKey = R"(
[camera]
width = 640
height = 480
fx = 500
fy = 501.5
cx = 320
cy = 240
model = "kannala-brandt"
distortion = [0.1, 0.2]
rolling_shutter_s = 0.03
[depth]
scale = 5000
[imu]
T_b_c = [0,-1,0,0.1, 1,0,0,0.2, 0,0,1,0.3, 0,0,0,1]
gyro_noise = 0.001
accel_noise = 0.01
gyro_walk = 0.0001
accel_walk = 0.002
time_offset_s = -0.005
)";

TEST(RigFile, ReadsEveryKey) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("rig.toml", kEveryKey);
  const OverriddenRig result = apply_rig_file(file, Rig{});
  const Rig& rig = result.rig;
  EXPECT_TRUE(result.has_extrinsic);
  EXPECT_EQ(rig.camera.width, 640);
  EXPECT_EQ(rig.camera.height, 480);
  EXPECT_EQ(rig.camera.fx, 500.0);
  EXPECT_EQ(rig.camera.fy, 501.5);
  EXPECT_EQ(rig.camera.cx, 320.0);
  EXPECT_EQ(rig.camera.cy, 240.0);
  EXPECT_EQ(rig.camera.model, CameraModel::kKannalaBrandt);
  EXPECT_EQ(rig.camera.distortion, (std::array<double, 8>{0.1, 0.2}));
  EXPECT_EQ(rig.rolling_shutter_s, 0.03);
  EXPECT_EQ(rig.depth_units_per_m, 5000.0);
  EXPECT_TRUE((rig.T_b_c * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0.1, 1.2, 0.3)));
  EXPECT_EQ(rig.imu_noise.gyro_noise, 0.001);
  EXPECT_EQ(rig.imu_noise.accel_noise, 0.01);
  EXPECT_EQ(rig.imu_noise.gyro_walk, 0.0001);
  EXPECT_EQ(rig.imu_noise.accel_walk, 0.002);
  EXPECT_EQ(rig.time_offset_s, -0.005);
}

TEST(RigFile, KeepsValuesThatItDoesNotSet) {
  const TemporaryFolder folder;
  Rig before;
  before.camera.fx = 123.0;
  before.camera.distortion[0] = 0.5;
  before.imu_noise.gyro_noise = 0.7;
  const OverriddenRig result = apply_rig_file(folder.write("rig.toml", "[camera]\nfy = 99\n"), before);
  EXPECT_FALSE(result.has_extrinsic);
  EXPECT_EQ(result.rig.camera.fx, 123.0);
  EXPECT_EQ(result.rig.camera.fy, 99.0);
  EXPECT_EQ(result.rig.camera.distortion[0], 0.5);
  EXPECT_EQ(result.rig.imu_noise.gyro_noise, 0.7);
}

TEST(RigFile, UnknownKeyErrorsNameTheLine) {
  expect_rejected("[camera]\nfx = 500\nfocal = 3\n", {"rig.toml:3", "\"focal\"", "width, height, fx"});
  expect_rejected("[lidar]\nrange = 3\n", {"rig.toml:1", "\"lidar\"", "camera, depth, imu"});
  expect_rejected("\n[imu]\nnoise = 1\n", {"rig.toml:3", "\"noise\""});
}

TEST(RigFile, TypeAndRangeErrorsNameTheLine) {
  expect_rejected("[camera]\nfx = \"500\"\n", {"rig.toml:2", "\"fx\" must be a finite number"});
  expect_rejected("[camera]\nfx = -1\n", {"rig.toml:2", "greater than 0"});
  expect_rejected("[camera]\nwidth = 640.5\n", {"rig.toml:2", "integer"});
  expect_rejected("[camera]\nfx = nan\n", {"rig.toml:2", "finite"});
  expect_rejected("[camera]\nmodel = \"fov\"\n", {"rig.toml:2", "radial-tangential"});
  expect_rejected("[camera]\ndistortion = [1,2,3,4,5,6,7,8,9]\n", {"rig.toml:2", "more than 8"});
  expect_rejected("[camera]\nmodel = \"kannala-brandt\"\ndistortion = [0.1,0,0,0,0.5]\n",
                  {"rig.toml:3", "\"distortion\"", "more than 4"});
  expect_rejected("[camera]\nrolling_shutter_s = -0.1\n", {"rig.toml:2", "must not be negative"});
  expect_rejected("[depth]\nscale = 0\n", {"rig.toml:2", "greater than 0"});
  expect_rejected("[imu]\nT_b_c = [1, 0]\n", {"rig.toml:2", "16 numbers"});
  expect_rejected("[imu]\nT_b_c = [2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n",
                  {"rig.toml:2", "not a rigid transform"});
  expect_rejected("camera = 3\n", {"rig.toml:1", "must be a table"});
}

TEST(RigFile, ReadsTheOffsetOfTheDepth) {
  const TemporaryFolder folder;
  const Rig before{.depth_offset = 0.01};
  EXPECT_EQ(apply_rig_file(folder.write("rig.toml", "[depth]\noffset = -0.006\n"), before).rig.depth_offset,
            -0.006);
  EXPECT_EQ(apply_rig_file(folder.write("rig.toml", "[depth]\nscale = 2\n"), before).rig.depth_offset, 0.01);
  expect_rejected("[depth]\noffset = -0.3\n", {"rig.toml:2", "\"offset\"", "1/m"});
}

TEST(RigFile, ReadsTheAxesOfTheInertialSensors) {
  const TemporaryFolder folder;
  Rig before;
  before.imu_axes.gyro(0, 0) = 1.02;
  const auto read = [&](const std::string& text) {
    return apply_rig_file(folder.write("rig.toml", text), before).rig.imu_axes;
  };
  const ImuAxes axes = read("[imu]\naccel_axes = [1.01, 0.002, 0.003, 0, 0.99, 0.004, 0, 0, 1]\n");
  EXPECT_EQ(axes.accel, (Eigen::Matrix3d{{1.01, 0.002, 0.003}, {0.0, 0.99, 0.004}, {0.0, 0.0, 1.0}}));
  EXPECT_EQ(axes.gyro, before.imu_axes.gyro);
  expect_rejected("[imu]\ngyro_axes = [1, 1, 1]\n", {"rig.toml:2", "\"gyro_axes\"", "9 numbers"});
  expect_rejected("[imu]\ngyro_axes = [0,0,0, 0,0,0, 0,0,0]\n", {"rig.toml:2", "\"gyro_axes\"", "identity"});
  expect_rejected("[imu]\naccel_axes = [1,0.3,0, 0,1,0, 0,0,1]\n",
                  {"rig.toml:2", "\"accel_axes\"", "identity"});
  expect_rejected("[imu]\naccel_axes = [nan,0,0, 0,1,0, 0,0,1]\n", {"rig.toml:2", "finite"});
}

TEST(RigFile, ACameraThatTheFormatDoesNotKnowMustBeComplete) {
  expect_rejected("\n[camera]\nwidth = 640\nheight = 480\nfx = 500\nfy = 500\ncx = 320\n",
                  {"rig.toml:2", "\"cy\" is missing"});
  const TemporaryFolder folder;
  const Rig known{.camera = {.width = 640, .height = 480, .fx = 500, .fy = 500, .cx = 320, .cy = 240}};
  EXPECT_EQ(apply_rig_file(folder.write("rig.toml", "[camera]\nfx = 510\n"), known).rig.camera.cy, 240.0);
}

TEST(RigFile, TheCameraOfUnregisteredDepthMustBeComplete) {
  const TemporaryFolder folder;
  const auto depth_camera = [&](const std::string& text) {
    return apply_rig_file(folder.write("rig.toml", text), Rig{}).depth_camera;
  };
  EXPECT_FALSE(depth_camera("[depth]\nscale = 1000\n"));
  const std::string intrinsics = "[depth]\nwidth = 4\nheight = 3\nfx = 5\nfy = 6\ncx = 1.5\n";
  const std::string pose = "T_c_d = [1,0,0,0.1, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n";
  const auto known = depth_camera(intrinsics + "cy = 1\n" + pose);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->camera.width, 4);
  EXPECT_EQ(known->camera.fy, 6.0);
  EXPECT_EQ(known->T_c_d.p.x(), 0.1);
  expect_rejected(intrinsics + pose, {"rig.toml:1", "\"cy\" is missing"});
  expect_rejected(intrinsics + "cy = 1\n", {"rig.toml:1", "\"T_c_d\" is missing"});
  expect_rejected(intrinsics + "cy = 1\nT_c_d = [1]\n", {"rig.toml:8", "\"T_c_d\"", "16 numbers"});
}

TEST(RigFile, InvalidTomlAndMissingFilesAreErrors) {
  expect_rejected("[camera\n", {"rig.toml:1", "not valid TOML"});
  for (const char* other :
       {"{\n\"value0\": {}}", "<?xml version=\"1.0\"?>", "# images\n1 PINHOLE 640 480 500"})
    expect_rejected(other, {"rig.toml:", "not valid TOML", "write its values into a rig.toml", "Kalibr"});
  const TemporaryFolder folder;
  expect_input_error([&] { static_cast<void>(apply_rig_file(folder.path(), Rig{})); },
                     {folder.path().string(), "is a folder"});
  expect_input_error([] { static_cast<void>(apply_rig_file("/nonexistent/rig.toml", Rig{})); },
                     {"no such rig file"});
}

}  // namespace
}  // namespace stillpoint::datasets
