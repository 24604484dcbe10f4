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

TEST(Camera, WithoutDistortionProjectsByThePinholeModel) {
  Camera camera = euroc_camera();
  camera.distortion = {};
  EXPECT_DOUBLE_EQ(camera.project({1.0, 0.0, 2.0}).x(), 0.5 * 458.654 + 367.215);
}

}  // namespace
}  // namespace stillpoint
