// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/semantic_mask.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stillpoint {
namespace {

constexpr double kExtent_m = 0.6;
constexpr Box kBox{.x_min = 20, .y_min = 10, .x_max = 70, .y_max = 79};

cv::Mat wall_at(int mm) { return cv::Mat(80, 100, CV_16UC1, cv::Scalar(mm)); }

void fill(cv::Mat& depth, int rows_from, int rows_to, int columns_from, int columns_to, int mm) {
  depth(cv::Range(rows_from, rows_to), cv::Range(columns_from, columns_to)) = cv::Scalar(mm);
}

TEST(ObjectDepthBand, ContainsThePersonButNotTheWallOrTheTableInFront) {
  cv::Mat depth = wall_at(4050);
  fill(depth, 15, 80, 30, 60, 2050);  // the person
  fill(depth, 60, 80, 0, 100, 1250);  // a table in front of the legs
  const DepthBand band = object_depth_band({depth, 1000.0}, kBox, kExtent_m);
  // The bin of 2.05 m is [2.0, 2.1), plus one bin on either side.
  EXPECT_NEAR(band.near_m, 1.9, 1e-9);
  EXPECT_NEAR(band.far_m, 2.2, 1e-9);
}

TEST(ObjectDepthBand, FindsLegsIfTheCenterShowsTheWall) {
  cv::Mat depth = wall_at(4050);
  fill(depth, 10, 80, 25, 42, 2050);
  fill(depth, 10, 80, 48, 65, 2150);
  const DepthBand band = object_depth_band({depth, 1000.0}, kBox, kExtent_m);
  EXPECT_LE(band.near_m, 2.05);
  EXPECT_GE(band.far_m, 2.15);
  EXPECT_LT(band.far_m, 4.0);
}

TEST(ObjectDepthBand, IsLimitedByTheExtentOnAContinuousFloor) {
  cv::Mat depth = wall_at(2050);
  for (int row = 0; row < depth.rows; ++row) depth.row(row) = 1000 + 50 * row;  // 1 m to 5 m, no gap anywhere
  const DepthBand band = object_depth_band({depth, 1000.0}, kBox, kExtent_m);
  // At most 6 bins plus one to either side of the mode: 15 bins.
  EXPECT_LE(band.far_m - band.near_m, 1.5 + 1e-9);
}

TEST(ObjectDepthBand, IsUnboundedWithoutValidDepth) {
  const DepthBand band = object_depth_band({cv::Mat::zeros(80, 100, CV_16UC1), 1000.0}, kBox, kExtent_m);
  EXPECT_EQ(band.near_m, 0.0);
  EXPECT_TRUE(std::isinf(band.far_m));
  EXPECT_TRUE(std::isinf(object_depth_band({cv::Mat(), 1000.0}, kBox, kExtent_m).far_m));
}

TEST(ObjectDepthBand, LimitsTheMaskToItsDepthRange) {
  cv::Mat depth = wall_at(4050);
  fill(depth, 15, 80, 30, 60, 2050);
  const SemanticMask mask(std::vector{kBox}, {depth, 1000.0}, depth.size(), DynamicConfig{});
  EXPECT_TRUE(mask.covers({45.0, 40.0}, 2.05));
  EXPECT_FALSE(mask.covers({45.0, 40.0}, 1.5));
  EXPECT_FALSE(mask.covers({45.0, 40.0}, 4.05));
  EXPECT_FALSE(mask.covers({95.0, 40.0}, 2.05));  // outside the box and its margin
}

}  // namespace
}  // namespace stillpoint
