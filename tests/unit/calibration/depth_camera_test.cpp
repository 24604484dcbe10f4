// SPDX-License-Identifier: BSD-3-Clause
// Calibration of a depth camera whose images are not registered, in a simulated corner of a room.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/calibration/calibrate.h"
#include "core/calibration/depth_edges.h"
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

/// Panels in front of the wall x = 4, all perpendicular to x: their planes do not tell how a depth camera is
/// moved beside the color camera, their edges do.
struct Panel {
  double x, y_min, y_max, z_min, z_max;
  std::uint8_t gray;
};
constexpr Panel kPanels[] = {{2.0, -0.2, 0.6, -0.5, 0.3, 180}, {2.8, -1.2, -0.4, -0.3, 0.6, 40}};
constexpr Panel kWall = {4.0, -100.0, 100.0, -100.0, 100.0, 110};

/// Surface that a ray meets, and the distance along it.
std::pair<const Panel*, double> nearest_panel(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  for (const Panel& panel : kPanels) {  // by ascending distance
    const double distance = (panel.x - from.x()) / direction.x();
    const Eigen::Vector3d point = from + distance * direction;
    if (point.y() > panel.y_min && point.y() < panel.y_max && point.z() > panel.z_min &&
        point.z() < panel.z_max)
      return {&panel, distance};
  }
  return {&kWall, (kWall.x - from.x()) / direction.x()};
}

cv::Mat depth_image(const Pose& T_w_d, const Camera& camera, double offset) {
  cv::Mat depth = cv::Mat::zeros(camera.height, camera.width, CV_16UC1);
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      const Eigen::Vector3d ray((column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy, 1.0);
      const double z = distance_to_wall(T_w_d.p, T_w_d.q * ray);
      const double measured = 1.0 / (1.0 / z + offset);
      if (z < 8.0)
        depth.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(std::lround(kUnits * measured));
    }
  }
  return depth;
}

Camera true_depth_camera() {
  return {.width = 640, .height = 480, .fx = 560.0, .fy = 560.0, .cx = 316.0, .cy = 243.0};
}
Pose true_T_c_d() { return {exp_so3({0.004, 0.012, 0.008}), {-0.025, 0.002, 0.0}}; }

/// Points on the walls, as the color camera tracks them.
/// @param offset of the measured inverse depths [1/m]
CalibrationInput room_recording(const Pose& T_c_d = true_T_c_d(),
                                const Camera& depth_camera = true_depth_camera(), double offset = 0.0) {
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
    CalibrationKeyframe keyframe{.T_w_c = T_w_c, .depth = depth_image(T_w_c * T_c_d, depth_camera, offset)};
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

/// An image of the panels, by the function of a surface and its distance.
template <typename Pixel>
cv::Mat panel_image(const Pose& T_w_c, const Camera& camera, Pixel (*value)(const Panel&, double)) {
  cv::Mat image(camera.height, camera.width, cv::DataType<Pixel>::type);
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      const Eigen::Vector3d ray((column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy, 1.0);
      const auto [panel, distance] = nearest_panel(T_w_c.p, T_w_c.q * ray);
      image.at<Pixel>(row, column) = value(*panel, distance);
    }
  }
  return image;
}

/// Points on the panels, as the color camera tracks them, and the images of both cameras.
CalibrationInput panel_recording() {
  Rig rig = SimulatedMotion::rig();
  Random random(5);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d toward = random.uniform3({4.0, -2.5, -1.5}, {4.0, 2.5, 1.5});
    points.emplace_back(nearest_panel(Eigen::Vector3d::Zero(), toward).second * toward);
  }
  CalibrationInput input{.stated = {.rig = rig, .depth_camera = true_depth_camera()},
                         .depth_is_registered = false};
  input.stated.rig.has_imu = false;
  input.stated.rig.T_b_c = Pose{};
  CalibrationSection& section = input.sections.emplace_back();
  for (int k = 0; k < 30; ++k) {
    const Pose T_w_c = SimulatedMotion::state(0.2 * k).T_w_b * rig.T_b_c;
    CalibrationKeyframe keyframe{
        .T_w_c = T_w_c,
        .depth =
            panel_image<std::uint16_t>(T_w_c * true_T_c_d(), true_depth_camera(),
                                       [](const Panel&, double distance) {
                                         return static_cast<std::uint16_t>(std::lround(kUnits * distance));
                                       }),
        .gray = panel_image<std::uint8_t>(T_w_c, rig.camera,
                                          [](const Panel& panel, double) { return panel.gray; })};
    keyframe.state.t = from_seconds(0.2 * k);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p_c = T_w_c.inverse() * points[i];
      if (p_c.z() < 0.5 || !rig.camera.contains(rig.camera.project(p_c))) continue;
      const Eigen::Vector3d toward = points[i] - T_w_c.p;
      if (nearest_panel(T_w_c.p, toward).second < 1.0 - 1e-6) continue;
      const Eigen::Vector2d noise = 0.2 * random.normal2();
      keyframe.features.push_back({.track = static_cast<std::int64_t>(i),
                                   .pixel = rig.camera.project(p_c) + noise,
                                   .depth_m = p_c.z()});
    }
    section.keyframes.push_back(std::move(keyframe));
  }
  return input;
}

TEST(DepthCamera, IsKnownBetterByEdges) {
  const CalibrationOptions options{.estimate = {.rolling_shutter = false, .depth_intrinsics = false},
                                   .hold_out = false};
  CalibrationInput input = panel_recording();
  const auto x_of = [](const CalibrationResult& result) {
    return *std::ranges::find(result.parameters, "T_c_d x", &ParameterEstimate::name);
  };
  const CalibrationResult result = calibrate(input, options);
  EXPECT_LT((result.calibration.T_c_d.p - true_T_c_d().p).head<2>().norm(), 0.002);
  EXPECT_LT(result.calibration.T_c_d.q.angularDistance(true_T_c_d().q), 0.002);
  EXPECT_LT(std::abs(x_of(result).value + 25.0), 3.0 * x_of(result).sigma);
  for (CalibrationKeyframe& keyframe : input.sections.front().keyframes) keyframe.gray.release();
  EXPECT_LT(x_of(result).sigma, x_of(calibrate(input, options)).sigma);
}

TEST(DepthEdges, AreWhereANearSurfaceEnds) {
  cv::Mat depth(100, 100, CV_16UC1, cv::Scalar(3000));
  depth(cv::Rect(40, 20, 30, 50)).setTo(1000);
  depth(cv::Rect(70, 20, 8, 50)).setTo(0);  // shadow of the projector
  const std::vector<DepthEdge> edges = depth_edges(depth, 1000.0);
  ASSERT_FALSE(edges.empty());
  bool left = false, right = false, top = false;
  for (const DepthEdge& edge : edges) {
    EXPECT_EQ(edge.depth_m, 1.0);
    left = left || (edge.pixel.x() == 39.5 && edge.normal.x() == -1.0);
    right = right || (edge.pixel.x() == 69.5 && edge.normal.x() == 1.0);
    top = top || (edge.pixel.y() == 19.5 && edge.normal.y() == -1.0);
  }
  EXPECT_TRUE(left && right && top);
}

TEST(ImageEdge, IsTheNearestOneAlongTheNormal) {
  cv::Mat image(60, 60, CV_8UC1, cv::Scalar(50));
  image.colRange(33, 60).setTo(150);  // edge at x = 32.5
  const Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  const std::optional<double> distance = image_edge(image, {30.0, 30.0}, normal, 5.0);
  ASSERT_TRUE(distance);
  EXPECT_NEAR(*distance, 2.5, 0.5);
  EXPECT_FALSE(image_edge(image, {24.0, 30.0}, normal, 5.0));
  EXPECT_FALSE(image_edge(image, {30.0, 30.0}, Eigen::Vector2d::UnitY(), 5.0));  // not across the edge
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

TEST(RegisteredDepth, ItsDisplacementAndOffsetAreFound) {
  const Camera color = SimulatedMotion::rig().camera;
  Camera displaced = color;
  displaced.cx += 3.0;
  displaced.cy -= 2.0;
  CalibrationInput input = room_recording(Pose{}, displaced, -0.006);
  input.depth_is_registered = true;
  const CalibrationResult result =
      calibrate(input, {.estimate = {.rolling_shutter = false}, .hold_out = false});
  const auto expect_near = [&](const std::string& name, double truth, double most) {
    const auto estimate = std::ranges::find(result.parameters, name, &ParameterEstimate::name);
    ASSERT_NE(estimate, result.parameters.end());
    EXPECT_NE(estimate->outcome, ParameterOutcome::kNotObserved) << name;
    EXPECT_NEAR(estimate->value, truth, std::min(most, 3.0 * estimate->sigma)) << name;
  };
  expect_near("depth shift x", 3.0, 1.0);
  expect_near("depth shift y", -2.0, 1.0);
  expect_near("depth offset", -0.006, 0.002);
  EXPECT_NEAR(result.calibration.rig.depth_offset, -0.006, 0.002);
  EXPECT_EQ(result.calibration.depth_camera.fx, color.fx);
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
