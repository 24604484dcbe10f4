// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration/depth_registration.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace stillpoint::datasets {
namespace {

constexpr double kUnits = 1000.0;

Camera pinhole(int width, int height, double focal) {
  return Camera{.width = width,
                .height = height,
                .fx = focal,
                .fy = focal,
                .cx = 0.5 * (width - 1),
                .cy = 0.5 * (height - 1),
                .model = CameraModel::kRadialTangential,
                .distortion = {}};
}

TEST(RegisterDepth, IsTheIdentityForTheSameCamera) {
  const Camera camera = pinhole(40, 30, 50.0);
  cv::Mat depth(30, 40, CV_16UC1, cv::Scalar(2000));
  depth.at<std::uint16_t>(10, 20) = 0;
  const cv::Mat registered = register_depth(depth, kUnits, {.camera = camera, .T_c_d = {}}, camera);
  EXPECT_EQ(registered.at<std::uint16_t>(5, 5), 2000);
  EXPECT_GE(cv::countNonZero(registered), 40 * 30 - 1);  // the margin may fill the hole
}

TEST(RegisterDepth, ShiftsByTheParallaxOfTheBaseline) {
  const Camera camera = pinhole(40, 30, 50.0);
  const Pose T_c_d{Eigen::Quaterniond::Identity(), {0.2, 0.0, 0.0}};
  cv::Mat depth = cv::Mat::zeros(30, 40, CV_16UC1);
  depth.at<std::uint16_t>(12, 10) = 2000;
  const cv::Mat registered = register_depth(depth, kUnits, {.camera = camera, .T_c_d = T_c_d}, camera);
  EXPECT_EQ(registered.at<std::uint16_t>(12, 15), 2000);  // 50 * 0.2 / 2 = 5 px
  EXPECT_EQ(cv::countNonZero(registered), 1);
}

TEST(RegisterDepth, KeepsTheNearestSurface) {
  const Camera camera = pinhole(40, 30, 50.0);
  const Pose T_c_d{Eigen::Quaterniond::Identity(), {0.2, 0.0, 0.0}};
  cv::Mat depth = cv::Mat::zeros(30, 40, CV_16UC1);
  depth.at<std::uint16_t>(12, 10) = 2000;  // moves by 5 px to column 15
  depth.at<std::uint16_t>(12, 5) = 1000;   // moves by 10 px to column 15
  const cv::Mat registered = register_depth(depth, kUnits, {.camera = camera, .T_c_d = T_c_d}, camera);
  EXPECT_EQ(registered.at<std::uint16_t>(12, 15), 1000);
}

TEST(RegisterDepth, LeavesNoHolesOnASlopeInAnImageOfHigherResolution) {
  const Camera depth_camera = pinhole(40, 30, 50.0);
  const Camera color = pinhole(60, 40, 90.0);  // 1.8 color pixels per depth pixel
  cv::Mat depth(30, 40, CV_16UC1);
  for (int column = 0; column < 40; ++column) depth.col(column).setTo(1500 + 12 * column);
  const Pose T_c_d{Eigen::Quaterniond::Identity(), {0.025, 0.0, 0.0}};
  const cv::Mat registered = register_depth(depth, kUnits, {.camera = depth_camera, .T_c_d = T_c_d}, color);
  EXPECT_EQ(cv::countNonZero(registered(cv::Rect(10, 5, 40, 30))), 40 * 30);
}

TEST(RegisterDepth, ReturnsDepthAlongTheOpticalAxisOfTheColorCamera) {
  const Camera camera = pinhole(41, 31, 50.0);
  const Pose T_c_d{Eigen::Quaterniond::Identity(), {0.0, 0.0, -0.5}};  // the color camera is 0.5 m ahead
  const cv::Mat depth(31, 41, CV_16UC1, cv::Scalar(2000));
  const cv::Mat registered = register_depth(depth, kUnits, {.camera = camera, .T_c_d = T_c_d}, camera);
  EXPECT_EQ(registered.at<std::uint16_t>(15, 20), 1500);
}

TEST(RegisterDepth, DropsPointsBehindTheColorCamera) {
  const Camera camera = pinhole(41, 31, 50.0);
  const Pose T_c_d{Eigen::Quaterniond::Identity(), {0.0, 0.0, -3.0}};
  const cv::Mat depth(31, 41, CV_16UC1, cv::Scalar(2000));
  EXPECT_EQ(cv::countNonZero(register_depth(depth, kUnits, {.camera = camera, .T_c_d = T_c_d}, camera)), 0);
}

}  // namespace
}  // namespace stillpoint::datasets
