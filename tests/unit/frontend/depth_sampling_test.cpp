// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/depth_sampling.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace stillpoint {
namespace {

constexpr double kUnitsPerMetre = 1000.0;

cv::Mat flat_depth() { return {20, 20, CV_16UC1, cv::Scalar(2000)}; }

TEST(DepthSampling, TakesTheNearestPixel) {
  cv::Mat depth = flat_depth();
  depth.at<std::uint16_t>(7, 5) = 2010;
  EXPECT_DOUBLE_EQ(sample_depth(depth, kUnitsPerMetre, {5.4, 6.6}, 0.0), 2.010);
  EXPECT_DOUBLE_EQ(sample_depth(depth, kUnitsPerMetre, {5.6, 6.6}, 0.0), 2.0);
}

TEST(DepthSampling, RefusesAnEdge) {
  cv::Mat depth = flat_depth();
  depth.at<std::uint16_t>(9, 11) = 2200;  // 10 % behind
  EXPECT_EQ(sample_depth(depth, kUnitsPerMetre, {10.0, 10.0}, 0.05), 0.0);
  EXPECT_DOUBLE_EQ(sample_depth(depth, kUnitsPerMetre, {10.0, 10.0}, 0.2), 2.0);
  EXPECT_DOUBLE_EQ(sample_depth(depth, kUnitsPerMetre, {10.0, 10.0}, 0.0), 2.0) << "0 means no check";
  EXPECT_DOUBLE_EQ(sample_depth(depth, kUnitsPerMetre, {8.0, 10.0}, 0.05), 2.0) << "out of its reach";
}

TEST(DepthSampling, MissingNeighboursAreNoEdge) {
  cv::Mat depth = flat_depth();
  depth.at<std::uint16_t>(9, 11) = 0;
  EXPECT_DOUBLE_EQ(sample_depth(depth, kUnitsPerMetre, {10.0, 10.0}, 0.05), 2.0);
}

TEST(DepthSampling, IsZeroWhereNothingWasMeasured) {
  cv::Mat depth = flat_depth();
  depth.at<std::uint16_t>(10, 10) = 0;
  EXPECT_EQ(sample_depth(depth, kUnitsPerMetre, {10.0, 10.0}, 0.05), 0.0);
  EXPECT_EQ(sample_depth(depth, kUnitsPerMetre, {-1.0, 10.0}, 0.05), 0.0);
  EXPECT_EQ(sample_depth(depth, kUnitsPerMetre, {10.0, 20.0}, 0.05), 0.0);
  EXPECT_EQ(sample_depth(cv::Mat(), kUnitsPerMetre, {10.0, 10.0}, 0.05), 0.0);
}

TEST(DepthSampling, WorksInTheCorners) {
  EXPECT_DOUBLE_EQ(sample_depth(flat_depth(), kUnitsPerMetre, {0.0, 0.0}, 0.05), 2.0);
  EXPECT_DOUBLE_EQ(sample_depth(flat_depth(), kUnitsPerMetre, {19.0, 19.0}, 0.05), 2.0);
}

}  // namespace
}  // namespace stillpoint
