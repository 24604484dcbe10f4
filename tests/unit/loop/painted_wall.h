// SPDX-License-Identifier: BSD-3-Clause
/// Images of a textured wall, as seen from known poses.
#pragma once

#include <opencv2/imgproc.hpp>

#include "core/geometry/camera.h"
#include "core/loop/keyframe.h"

namespace stillpoint {

inline const Camera kWallCamera{
    .width = 424, .height = 240, .fx = 305.5, .fy = 305.5, .cx = 211.5, .cy = 119.5};
constexpr double kWallPixelsPerMeter = 150.0;

/// A wall in the plane z = 0 that extends 16 m along x and 3 m along y, with random rectangles.
inline cv::Mat painted_wall(std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat wall(450, 2400, CV_8UC1, cv::Scalar(128));
  for (int i = 0; i < 4000; ++i) {
    const int y = random.uniform(0, wall.rows), x = random.uniform(0, wall.cols);  // in a defined order
    const int height = random.uniform(6, 60), width = random.uniform(6, 60);
    cv::rectangle(wall, cv::Rect(x, y, width, height), cv::Scalar(random.uniform(20, 235)), cv::FILLED);
  }
  return wall;
}

/// The wall as seen by a camera at `T_w_c`; the body is the camera.
inline DepartedKeyframe keyframe_at(const cv::Mat& wall, const Pose& T_w_c, std::int64_t frame) {
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  K << kWallCamera.fx, 0.0, kWallCamera.cx, 0.0, kWallCamera.fy, kWallCamera.cy, 0.0, 0.0, 1.0;
  const Pose T_c_w = T_w_c.inverse();
  Eigen::Matrix3d from_wall;  // metric wall coordinates to the camera frame
  from_wall << T_c_w.R().leftCols<2>(), T_c_w.p;
  const Eigen::Matrix3d H =
      K * from_wall * Eigen::Vector3d(1.0 / kWallPixelsPerMeter, 1.0 / kWallPixelsPerMeter, 1.0).asDiagonal();
  cv::Mat homography(3, 3, CV_64F);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) homography.at<double>(row, column) = H(row, column);
  }
  DepartedKeyframe keyframe{.frame = frame, .t = from_seconds(0.1 * static_cast<double>(frame))};
  cv::warpPerspective(wall, keyframe.gray, homography, {kWallCamera.width, kWallCamera.height},
                      cv::INTER_AREA);
  keyframe.depth.create(kWallCamera.height, kWallCamera.width, CV_16UC1);
  for (int v = 0; v < kWallCamera.height; ++v) {
    for (int u = 0; u < kWallCamera.width; ++u) {
      const Eigen::Vector3d ray((u - kWallCamera.cx) / kWallCamera.fx, (v - kWallCamera.cy) / kWallCamera.fy,
                                1.0);
      const double depth_m = -T_w_c.p.z() / (T_w_c.q * ray).z();
      keyframe.depth.at<std::uint16_t>(v, u) = cv::saturate_cast<std::uint16_t>(1000.0 * depth_m);
    }
  }
  return keyframe;
}

}  // namespace stillpoint
