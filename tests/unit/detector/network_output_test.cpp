// SPDX-License-Identifier: BSD-3-Clause
#include "core/detector/network_detector.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint {
namespace {

DecodeOptions options_for(NetworkLayout layout) {
  return {.layout = layout, .input_px = 320, .names = {"cat", "person"}, .score_threshold = 0.3};
}

/// Adds the batch dimension: 1 x rows x columns.
cv::Mat batch(const cv::Mat& rows) {
  const int shape[] = {1, rows.rows, rows.cols};
  return rows.clone().reshape(1, 3, shape);
}

void expect_person(const std::vector<Detection>& detections, double score, const Box& box) {
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_EQ(detections[0].class_name, "person");
  EXPECT_NEAR(detections[0].score, score, 1e-6);
  EXPECT_NEAR(detections[0].box.x_min, box.x_min, 1e-4);
  EXPECT_NEAR(detections[0].box.y_min, box.y_min, 1e-4);
  EXPECT_NEAR(detections[0].box.x_max, box.x_max, 1e-4);
  EXPECT_NEAR(detections[0].box.y_max, box.y_max, 1e-4);
}

TEST(NetworkOutput, DecodesDarknetRowsRelativeToTheInput) {
  // Center (0.5, 0.25) * 320 = (160, 80), size (0.2, 0.4) * 320 = (64, 128). The score includes the
  // objectness.
  const cv::Mat rows = (cv::Mat_<float>(2, 7) << 0.5, 0.25, 0.2, 0.4, 0.9, 0.1, 0.8,  //
                        0.1, 0.1, 0.1, 0.1, 0.9, 0.2, 0.1);
  expect_person(decode_outputs(options_for(NetworkLayout::kDarknet), {rows}, "net"), 0.8,
                {.x_min = 128, .y_min = 16, .x_max = 192, .y_max = 144});
}

TEST(NetworkOutput, ConcatenatesDarknetOutputs) {
  const cv::Mat rows = (cv::Mat_<float>(1, 7) << 0.5, 0.5, 0.2, 0.4, 0.9, 0.1, 0.8);
  EXPECT_EQ(decode_outputs(options_for(NetworkLayout::kDarknet), {rows, rows}, "net").size(), 2U);
}

TEST(NetworkOutput, DecodesYolov5RowsInPixels) {
  const cv::Mat rows = (cv::Mat_<float>(2, 7) << 160, 80, 64, 128, 0.5, 0.1, 0.8,  //
                        160, 80, 64, 128, 0.5, 0.1, 0.5);
  // 0.5 * 0.8 = 0.4 is above the threshold, 0.5 * 0.5 = 0.25 is not.
  expect_person(decode_outputs(options_for(NetworkLayout::kYolov5), {batch(rows)}, "net"), 0.4,
                {.x_min = 128, .y_min = 16, .x_max = 192, .y_max = 144});
}

TEST(NetworkOutput, DecodesYolov8Columns) {
  const cv::Mat rows = (cv::Mat_<float>(3, 6) << 160, 80, 64, 128, 0.1, 0.8,  //
                        10, 10, 5, 5, 0.1, 0.1, 10, 10, 5, 5, 0.1, 0.2);
  expect_person(decode_outputs(options_for(NetworkLayout::kYolov8), {batch(rows.t())}, "net"), 0.8,
                {.x_min = 128, .y_min = 16, .x_max = 192, .y_max = 144});
}

TEST(NetworkOutput, DecodesTheGridsOfYolox) {
  // Input of 32 px: grids of 16, 4 and 1 cells. Row 16 + 3 is the cell (1, 1) of stride 16: center
  // (1 + 0.25, 1 - 0.5) * 16 = (20, 8), size exp(0) * 16 = 16 each; score 0.5 * 0.8.
  cv::Mat rows = cv::Mat::zeros(21, 7, CV_32F);
  const std::vector<float> cell = {0.25F, -0.5F, 0.0F, 0.0F, 0.5F, 0.1F, 0.8F};
  for (int i = 0; i < 7; ++i) rows.at<float>(16 + 3, i) = cell[static_cast<std::size_t>(i)];
  DecodeOptions small = options_for(NetworkLayout::kYolox);
  small.input_px = 32;
  expect_person(decode_outputs(small, {batch(rows)}, "net"), 0.4,
                {.x_min = 12, .y_min = 0, .x_max = 28, .y_max = 16});
}

TEST(NetworkOutput, RejectsOutputsOfAnotherLayout) {
  const cv::Mat seven_columns = cv::Mat::zeros(10, 7, CV_32F);
  DecodeOptions three_classes = options_for(NetworkLayout::kDarknet);
  three_classes.names.emplace_back("dog");
  expect_input_error(
      [&] { static_cast<void>(decode_outputs(three_classes, {seven_columns}, "net.weights")); },
      {"net.weights", "10 x 7", "3 classes", "detector.names"});
  expect_input_error(
      [&] {
        static_cast<void>(
            decode_outputs(options_for(NetworkLayout::kYolov8), {batch(seven_columns)}, "net.onnx"));
      },
      {"net.onnx", "1 x 10 x 7", "detector.layout"});
  expect_input_error(
      [&] {
        static_cast<void>(
            decode_outputs(options_for(NetworkLayout::kYolox), {batch(seven_columns)}, "net.onnx"));
      },
      {"detector.input_px"});  // 320 px have 2100 cells, not 10
}

Detection scored(double score, double x, const std::string& name = "person") {
  return {
      .class_name = name, .score = score, .box = {.x_min = x, .y_min = 0, .x_max = x + 100, .y_max = 100}};
}

TEST(NonMaximumSuppression, KeepsTheBetterOfTwoOverlappingBoxes) {
  // Shift of 20 px: 80 / 120 = 0.67.
  const auto remaining = non_maximum_suppression({scored(0.5, 0), scored(0.9, 20)}, 0.45);
  ASSERT_EQ(remaining.size(), 1U);
  EXPECT_EQ(remaining[0].score, 0.9);
}

TEST(NonMaximumSuppression, KeepsNeighborsAndOtherClasses) {
  EXPECT_EQ(non_maximum_suppression({scored(0.5, 0), scored(0.9, 50)}, 0.45).size(), 2U);  // 50 / 150 = 0.33
  EXPECT_EQ(non_maximum_suppression({scored(0.5, 0), scored(0.9, 0, "cat")}, 0.45).size(), 2U);
}

TEST(NonMaximumSuppression, ASuppressedBoxDoesNotSuppressOthers) {
  // Each overlaps the next by 67 %, the first and the last by 60 / 140 = 43 %.
  EXPECT_EQ(non_maximum_suppression({scored(0.9, 0), scored(0.8, 20), scored(0.7, 40)}, 0.45).size(), 2U);
}

}  // namespace
}  // namespace stillpoint
