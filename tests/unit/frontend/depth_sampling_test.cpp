// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/track.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace stillpoint {
namespace {

constexpr double kUnitsPerM = 1000.0;

cv::Mat flat_depth() { return {20, 20, CV_16UC1, cv::Scalar(2000)}; }

TEST(DepthSampling, UsesTheNearestPixel) {
  cv::Mat depth = flat_depth();
  depth.at<std::uint16_t>(7, 5) = 2010;
  EXPECT_DOUBLE_EQ(sample_depth(depth, kUnitsPerM, {5.4, 6.6}, 0.0), 2.010);
  EXPECT_DOUBLE_EQ(sample_depth(depth, kUnitsPerM, {5.6, 6.6}, 0.0), 2.0);
}

TEST(DepthSampling, RejectsADepthDiscontinuity) {
  cv::Mat depth = flat_depth();
  depth.at<std::uint16_t>(9, 11) = 2200;  // 10 % behind
  EXPECT_EQ(sample_depth(depth, kUnitsPerM, {10.0, 10.0}, 0.05), 0.0);
  EXPECT_DOUBLE_EQ(sample_depth(depth, kUnitsPerM, {10.0, 10.0}, 0.2), 2.0);
  EXPECT_DOUBLE_EQ(sample_depth(depth, kUnitsPerM, {10.0, 10.0}, 0.0), 2.0) << "0 means no check";
  EXPECT_DOUBLE_EQ(sample_depth(depth, kUnitsPerM, {8.0, 10.0}, 0.05), 2.0) << "outside the 3x3 neighborhood";
}

TEST(DepthSampling, IgnoresUnmeasuredNeighbors) {
  cv::Mat depth = flat_depth();
  depth.at<std::uint16_t>(9, 11) = 0;
  EXPECT_DOUBLE_EQ(sample_depth(depth, kUnitsPerM, {10.0, 10.0}, 0.05), 2.0);
}

TEST(DepthSampling, IsZeroWithoutMeasurement) {
  cv::Mat depth = flat_depth();
  depth.at<std::uint16_t>(10, 10) = 0;
  EXPECT_EQ(sample_depth(depth, kUnitsPerM, {10.0, 10.0}, 0.05), 0.0);
  EXPECT_EQ(sample_depth(depth, kUnitsPerM, {-1.0, 10.0}, 0.05), 0.0);
  EXPECT_EQ(sample_depth(depth, kUnitsPerM, {10.0, 20.0}, 0.05), 0.0);
  EXPECT_EQ(sample_depth(cv::Mat(), kUnitsPerM, {10.0, 10.0}, 0.05), 0.0);
}

TEST(DepthSampling, WorksInTheImageCorners) {
  EXPECT_DOUBLE_EQ(sample_depth(flat_depth(), kUnitsPerM, {0.0, 0.0}, 0.05), 2.0);
  EXPECT_DOUBLE_EQ(sample_depth(flat_depth(), kUnitsPerM, {19.0, 19.0}, 0.05), 2.0);
}

}  // namespace
}  // namespace stillpoint
