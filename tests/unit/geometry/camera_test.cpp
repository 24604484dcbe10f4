// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/camera.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

Camera euroc_camera() {
  return Camera{.width = 752,
                .height = 480,
                .fx = 458.654,
                .fy = 457.296,
                .cx = 367.215,
                .cy = 248.375,
                .model = CameraModel::kRadialTangential,
                .distortion = {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0}};
}

void expect_round_trip(const Camera& camera) {
  for (double v = 0.0; v < camera.height; v += 60.0) {
    for (double u = 0.0; u < camera.width; u += 94.0) {
      const Eigen::Vector2d m = camera.unproject({u, v});
      const Eigen::Vector2d pixel = camera.project({2.0 * m.x(), 2.0 * m.y(), 2.0});
      EXPECT_LT((pixel - Eigen::Vector2d(u, v)).norm(), 1e-6) << u << " " << v;
    }
  }
}

TEST(Camera, UnprojectInvertsProjectWithRadialTangentialDistortion) { expect_round_trip(euroc_camera()); }

TEST(Camera, UnprojectInvertsProjectWithKannalaBrandtDistortion) {
  Camera camera = euroc_camera();
  camera.model = CameraModel::kKannalaBrandt;
  camera.distortion = {-0.01, 0.004, -0.002, 0.0005, 0.0};
  expect_round_trip(camera);
}

/// The color camera of an Azure Kinect at 1280x720.
Camera azure_kinect_camera() {
  return Camera{.width = 1280,
                .height = 720,
                .fx = 613.02,
                .fy = 612.93,
                .cx = 648.6,
                .cy = 374.0,
                .model = CameraModel::kRadialTangential,
                .distortion = {0.40386, -2.60288, 8.94e-4, -4.2e-5, 1.51188, 0.28428, -2.42072, 1.43544}};
}

TEST(Camera, UnprojectInvertsProjectWithARationalLens) { expect_round_trip(azure_kinect_camera()); }

TEST(Camera, ARationalLensDividesByItsDenominator) {
  Camera camera = azure_kinect_camera();
  camera.distortion = {0.5, 0.0, 0.0, 0.0, 0.0, 0.25, 0.5, 1.0};
  // r^2 = 1: (1 + 0.5) / (1 + 0.25 + 0.5 + 1) = 6 / 11
  EXPECT_NEAR(camera.project({2.0, 0.0, 2.0}).x(), 613.02 * 6.0 / 11.0 + 648.6, 1e-9);
  EXPECT_EQ(camera.coefficients().size(), 8u);
  camera.distortion = {0.5};
  EXPECT_EQ(camera.coefficients().size(), 5u);
}

TEST(Camera, WithoutDistortionProjectsByThePinholeModel) {
  Camera camera = euroc_camera();
  camera.distortion = {};
  EXPECT_DOUBLE_EQ(camera.project({1.0, 0.0, 2.0}).x(), 0.5 * 458.654 + 367.215);
}

}  // namespace
}  // namespace stillpoint
