// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/semantic_mask.h"
#include "tests/support/published_config.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace stillpoint {
namespace {

constexpr double kEpsilon = 0.5;  // [m]
const cv::Size kSize(100, 80);

TEST(ObjectDepthThreshold, IsTheMeanOfObjectAndBackgroundForAClearGap) {
  const BoxDepths person_before_wall{.corners = {4.0, 3.9, 0.0, 4.0}, .center = 2.0};
  EXPECT_DOUBLE_EQ(object_depth_threshold(person_before_wall, kEpsilon), 3.0);  // (4 + 2) / 2
}

TEST(ObjectDepthThreshold, IsEpsilonBehindAnObjectCloseToItsBackground) {
  const BoxDepths close{.corners = {2.3, 2.2, 0.0, 0.0}, .center = 2.0};  // gap 0.3 < 0.5
  EXPECT_DOUBLE_EQ(object_depth_threshold(close, kEpsilon), 2.5);
}

TEST(ObjectDepthThreshold, IsEpsilonBehindAnOccludedObject) {
  const BoxDepths behind{.corners = {1.0, 1.0, 1.0, 1.0}, .center = 2.0};  // gap -1 < 0.5
  EXPECT_DOUBLE_EQ(object_depth_threshold(behind, kEpsilon), 2.5);
}

TEST(ObjectDepthThreshold, UsesTheSecondCaseIfTheGapEqualsEpsilon) {
  const BoxDepths equal{.corners = {2.5, 0.0, 0.0, 0.0}, .center = 2.0};
  EXPECT_DOUBLE_EQ(object_depth_threshold(equal, kEpsilon), 2.5);  // not (2.5 + 2) / 2 = 2.25
}

TEST(ObjectDepthThreshold, UsesTheSecondCaseIfNoCornerWasMeasured) {
  EXPECT_DOUBLE_EQ(object_depth_threshold({.corners = {}, .center = 2.0}, kEpsilon), 2.5);
}

TEST(ObjectDepthThreshold, IsTheBackgroundDepthIfTheCenterWasNotMeasured) {
  EXPECT_DOUBLE_EQ(object_depth_threshold({.corners = {0.0, 3.0, 1.0, 0.0}, .center = 0.0}, kEpsilon), 3.0);
}

TEST(ObjectDepthThreshold, IsInfiniteIfNothingWasMeasured) {
  EXPECT_TRUE(std::isinf(object_depth_threshold({.corners = {}, .center = 0.0}, kEpsilon)));
}

/// A wall at 4 m, and an object at 2 m in columns 30..60, rows 20..70.
cv::Mat person_before_wall() {
  cv::Mat depth(kSize, CV_16UC1, cv::Scalar(4000));
  depth(cv::Range(20, 71), cv::Range(30, 61)) = cv::Scalar(2000);
  return depth;
}

/// Its detection: the corners of the box show the wall, the center (45, 44.5) the object.
constexpr Box kPersonBox{.x_min = 20, .y_min = 10, .x_max = 70, .y_max = 79};

DynamicConfig tight() {
  DynamicConfig config = published_config().dynamic;
  config.box_margin_px = 0.0;
  return config;
}

SemanticMask mask_of(const std::vector<Box>& boxes, const cv::Mat& depth, const DynamicConfig& config) {
  return SemanticMask(boxes, DepthView{.pixels = depth}, kSize, config);
}

TEST(MedianDepth, IsTheDepthOfThePixelForAWindowOfOne) {
  cv::Mat depth(kSize, CV_16UC1, cv::Scalar(4000));
  depth.at<std::uint16_t>(10, 20) = 1234;
  EXPECT_DOUBLE_EQ(median_depth({depth, 1000.0}, {20.4, 9.6}, 1), 1.234);  // rounds to column 20, row 10
  depth.at<std::uint16_t>(10, 20) = 0;
  EXPECT_EQ(median_depth({depth, 1000.0}, {20.0, 10.0}, 1), 0.0);
}

TEST(MedianDepth, IsTheMedianOfTheValidDepths) {
  cv::Mat depth = cv::Mat::zeros(kSize, CV_16UC1);
  depth.at<std::uint16_t>(9, 19) = 9000;
  depth.at<std::uint16_t>(10, 21) = 2100;
  depth.at<std::uint16_t>(11, 20) = 2000;
  EXPECT_DOUBLE_EQ(median_depth({depth, 1000.0}, {20.0, 10.0}, 3), 2.1);  // of 2.0, 2.1, 9.0
  depth.at<std::uint16_t>(9, 19) = 0;
  EXPECT_DOUBLE_EQ(median_depth({depth, 1000.0}, {20.0, 10.0}, 3), 2.1);  // upper median of 2.0, 2.1
}

TEST(MedianDepth, ClipsTheWindowToTheImage) {
  cv::Mat depth(kSize, CV_16UC1, cv::Scalar(3000));
  EXPECT_DOUBLE_EQ(median_depth({depth, 1000.0}, {0.0, 0.0}, 5), 3.0);
  EXPECT_EQ(median_depth({depth, 1000.0}, {-50.0, 0.0}, 5), 0.0);
  EXPECT_EQ(median_depth({cv::Mat(), 1000.0}, {10.0, 10.0}, 5), 0.0);
}

TEST(MedianDepth, UsesTheUnitsOfTheSensor) {
  const cv::Mat depth(kSize, CV_16UC1, cv::Scalar(10000));
  EXPECT_DOUBLE_EQ(median_depth({depth, 5000.0}, {5.0, 5.0}, 1), 2.0);  // TUM: 5000 per meter
}

TEST(SemanticMask, HasTheThresholdInsideTheBoxAndZeroOutside) {
  const SemanticMask mask = mask_of({kPersonBox}, person_before_wall(), tight());
  EXPECT_DOUBLE_EQ(mask.threshold_at({45.0, 40.0}), 3.0);  // gap 2 > 1: (4 + 2) / 2
  EXPECT_DOUBLE_EQ(mask.threshold_at({20.0, 10.0}), 3.0);  // edges are inside
  EXPECT_EQ(mask.threshold_at({19.9, 40.0}), 0.0);
  EXPECT_EQ(mask.threshold_at({45.0, 9.9}), 0.0);
}

TEST(SemanticMask, EnlargesBoxesByTheMargin) {
  DynamicConfig config = tight();
  config.box_margin_px = 10.0;
  const SemanticMask mask = mask_of({kPersonBox}, person_before_wall(), config);
  EXPECT_GT(mask.threshold_at({10.0, 40.0}), 0.0);
  EXPECT_EQ(mask.threshold_at({9.9, 40.0}), 0.0);
  EXPECT_GT(mask.threshold_at({80.0, 0.0}), 0.0);
}

TEST(SemanticMask, HasTheLargerThresholdWhereBoxesOverlap) {
  // Second box: 2 m at the center (45, 45) and at the corners: 2 + 1 = 3. First box: 4 m everywhere: 4 + 1
  // = 5.
  const Box wall{.x_min = 0, .y_min = 0, .x_max = 50, .y_max = 79};
  const Box inner{.x_min = 40, .y_min = 40, .x_max = 50, .y_max = 50};
  cv::Mat depth = person_before_wall();
  for (const auto& boxes : {std::vector<Box>{wall, inner}, std::vector<Box>{inner, wall}}) {
    const SemanticMask mask = mask_of(boxes, depth, tight());
    EXPECT_DOUBLE_EQ(mask.threshold_at({45.0, 45.0}), 5.0);
    EXPECT_DOUBLE_EQ(mask.threshold_at({5.0, 5.0}), 5.0);
  }
  EXPECT_DOUBLE_EQ(mask_of({inner}, depth, tight()).threshold_at({45.0, 45.0}), 3.0);
}

TEST(SemanticMask, WholeBoxHasAnInfiniteThreshold) {
  DynamicConfig config = tight();
  config.mask = DynamicMask::kWholeBox;
  const SemanticMask mask = mask_of({kPersonBox}, person_before_wall(), config);
  EXPECT_TRUE(std::isinf(mask.threshold_at({45.0, 40.0})));
  EXPECT_EQ(mask.threshold_at({5.0, 40.0}), 0.0);
}

TEST(SemanticMask, IsEmptyIfOff) {
  DynamicConfig config = tight();
  config.mask = DynamicMask::kOff;
  EXPECT_EQ(mask_of({kPersonBox}, person_before_wall(), config).threshold_at({45.0, 40.0}), 0.0);
}

TEST(SemanticMask, MasksTheWholeBoxWithoutADepthImage) {
  EXPECT_TRUE(std::isinf(mask_of({kPersonBox}, cv::Mat(), tight()).threshold_at({45.0, 40.0})));
}

TEST(SemanticMask, ClipsBoxesToTheImage) {
  const Box beyond{.x_min = -500, .y_min = 10, .x_max = 60, .y_max = 9000};
  const SemanticMask mask = mask_of({beyond}, person_before_wall(), tight());
  ASSERT_EQ(mask.boxes().size(), 1U);
  EXPECT_EQ(mask.boxes()[0].box.x_min, 0.0);
  EXPECT_EQ(mask.boxes()[0].box.y_max, 79.0);
  // Center (30, 44.5) on the object, all corners on the wall: (4 + 2) / 2.
  EXPECT_DOUBLE_EQ(mask.boxes()[0].threshold_m, 3.0);
}

TEST(SemanticMask, IgnoresInvalidBoxes) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Box> broken = {{.x_min = 60, .y_min = 10, .x_max = 20, .y_max = 40},
                                   {.x_min = 200, .y_min = 10, .x_max = 300, .y_max = 40},
                                   {.x_min = kNan, .y_min = 10, .x_max = 30, .y_max = 40}};
  EXPECT_TRUE(mask_of(broken, person_before_wall(), DynamicConfig{}).boxes().empty());
}

}  // namespace
}  // namespace stillpoint
