// SPDX-License-Identifier: BSD-3-Clause
// Calibration of a depth camera whose images are not registered, in a simulated corner of a room.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/calibration/calibrate.h"
#include "core/calibration/depth_patch.h"
#include "core/geometry/so3.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

constexpr double kUnits = 1000.0;

/// The room: x < 4, y < 2, z > -1.2 [m]; the camera looks along x. The distance along a ray is that of the
/// nearest wall.
double distance_to_wall(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d walls(4.0, 2.0, -1.2);
  for (int axis = 0; axis < 3; ++axis) {
    const double distance = (walls[axis] - from[axis]) / direction[axis];
    if (std::isfinite(distance) && distance > 0.0) nearest = std::min(nearest, distance);
  }
  return nearest;
}

cv::Mat depth_image(const Pose& T_w_d, const Camera& camera) {
  cv::Mat depth = cv::Mat::zeros(camera.height, camera.width, CV_16UC1);
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      const Eigen::Vector3d ray((column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy, 1.0);
      const double z = distance_to_wall(T_w_d.p, T_w_d.q * ray);
      if (z < 8.0) depth.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(std::lround(kUnits * z));
    }
  }
  return depth;
}

Camera true_depth_camera() {
  return {.width = 640, .height = 480, .fx = 560.0, .fy = 560.0, .cx = 316.0, .cy = 243.0};
}
Pose true_T_c_d() { return {exp_so3({0.004, 0.012, 0.008}), {-0.025, 0.002, 0.0}}; }

/// Points on the walls, as the color camera tracks them.
CalibrationInput room_recording() {
  const Rig rig = SimulatedMotion::rig();
  Random random(3);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 300; ++i) {
    Eigen::Vector3d point = random.uniform3({2.0, -2.5, -1.2}, {4.0, 2.0, 1.5});
    point[i % 3] = Eigen::Vector3d(4.0, 2.0, -1.2)[i % 3];
    points.push_back(point);
  }
  CalibrationInput input{.stated = {.rig = rig, .depth_camera = rig.camera}, .depth_is_registered = false};
  input.stated.rig.has_imu = false;
  input.stated.rig.T_b_c = Pose{};
  CalibrationSection& section = input.sections.emplace_back();
  for (int k = 0; k < 50; ++k) {
    const Pose T_w_c = SimulatedMotion::state(0.2 * k).T_w_b * rig.T_b_c;
    CalibrationKeyframe keyframe{.T_w_c = T_w_c,
                                 .depth = depth_image(T_w_c * true_T_c_d(), true_depth_camera())};
    keyframe.state.t = from_seconds(0.2 * k);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p_c = T_w_c.inverse() * points[i];
      if (p_c.z() < 0.5 || !rig.camera.contains(rig.camera.project(p_c))) continue;
      const Eigen::Vector2d noise = 0.2 * random.normal2();
      keyframe.features.push_back({.track = static_cast<std::int64_t>(i),
                                   .pixel = rig.camera.project(p_c) + noise,
                                   .depth_m = p_c.z()});
    }
    section.keyframes.push_back(std::move(keyframe));
  }
  return input;
}

TEST(DepthCamera, IsFoundFromImagesThatAreNotRegistered) {
  const CalibrationResult result =
      calibrate(room_recording(), {.estimate = {.rolling_shutter = false}, .hold_out = false});
  const Camera& found = result.calibration.depth_camera;
  EXPECT_NEAR(found.fx, 560.0, 3.0);
  EXPECT_NEAR(found.fy, 560.0, 3.0);
  EXPECT_NEAR(found.cx, 316.0, 3.0);
  EXPECT_NEAR(found.cy, 243.0, 3.0);
  EXPECT_LT((result.calibration.T_c_d.p - true_T_c_d().p).norm(), 0.003);
  EXPECT_LT(result.calibration.T_c_d.q.angularDistance(true_T_c_d().q), 0.005);
  const auto error_in_sigmas = [&](const std::string& name, double truth) {
    const auto estimate = std::ranges::find(result.parameters, name, &ParameterEstimate::name);
    return (estimate->value - truth) / estimate->sigma;
  };
  EXPECT_LT(std::abs(error_in_sigmas("depth fx", 560.0)), 3.0);
  EXPECT_LT(std::abs(error_in_sigmas("depth cy", 243.0)), 3.0);
  EXPECT_LT(std::abs(error_in_sigmas("T_c_d x", -25.0)), 3.0);
}

TEST(DepthCamera, KeepsItsStatedIntrinsicsIfWanted) {
  CalibrationInput input = room_recording();
  input.stated.depth_camera = true_depth_camera();
  const CalibrationResult result = calibrate(
      input, {.estimate = {.rolling_shutter = false, .depth_intrinsics = false}, .hold_out = false});
  EXPECT_EQ(result.calibration.depth_camera.fx, 560.0);
  EXPECT_LT((result.calibration.T_c_d.p - true_T_c_d().p).norm(), 0.003);
}

TEST(DepthPatch, IsThePlaneOfInverseDepthAndNotAnEdge) {
  // z = 2 / (1 + 0.001 x): inverse depth 0.5 + 0.0005 x.
  cv::Mat depth(100, 100, CV_16UC1);
  for (int row = 0; row < 100; ++row) {
    for (int x = 0; x < 100; ++x)
      depth.at<std::uint16_t>(row, x) = static_cast<std::uint16_t>(std::lround(20000.0 / (1.0 + 0.001 * x)));
  }
  const auto patch = depth_patch(depth, 10000.0, {50.3, 50.0});
  ASSERT_TRUE(patch);
  EXPECT_NEAR(patch->inverse_depth, 0.525, 1e-4);
  EXPECT_NEAR(patch->gradient.x(), 0.0005, 1e-5);
  EXPECT_NEAR(patch->gradient.y(), 0.0, 1e-5);
  depth.colRange(51, 100).setTo(10000);
  EXPECT_FALSE(depth_patch(depth, 10000.0, {50.3, 50.0}));
  EXPECT_FALSE(depth_patch(depth, 10000.0, {2.0, 50.0}));
}

}  // namespace
}  // namespace stillpoint
