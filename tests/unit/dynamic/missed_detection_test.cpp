// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/missed_detection.h"
#include "tests/support/published_config.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

/// No growth, as in the paper, so that the boxes show the motion only.
DynamicConfig without_growth() {
  DynamicConfig config = published_config().dynamic;
  config.growth_px_per_miss = 0.0;
  return config;
}

/// A person's box of 100 x 200 px whose left edge is at `x`.
Detection person(double x) {
  return {
      .class_name = "person", .score = 0.9, .box = {.x_min = x, .y_min = 50, .x_max = x + 100, .y_max = 250}};
}

DetectionSet detected(std::vector<Detection> detections) {
  return {.t = {}, .state = DetectionState::kPresent, .detections = std::move(detections)};
}
DetectionSet missed() { return detected({}); }
DetectionSet skipped() { return {.t = {}, .state = DetectionState::kNone, .detections = {}}; }
DetectionSet late_set() { return {.t = {}, .state = DetectionState::kLate, .detections = {}}; }

/// Left edge of the only box.
double left_edge(const std::vector<TrackedBox>& boxes) {
  EXPECT_EQ(boxes.size(), 1U);
  return boxes.empty() ? -1.0 : boxes.front().box.x_min;
}

TEST(MissedDetection, ReturnsDetectedBoxes) {
  MissedDetectionCompensation compensation{without_growth()};
  const auto boxes = compensation.update(detected({person(10), person(400)}));
  ASSERT_EQ(boxes.size(), 2U);
  EXPECT_EQ(boxes[0].box.x_min, 10.0);
  EXPECT_EQ(boxes[1].box.x_min, 400.0);
  EXPECT_FALSE(boxes[0].compensated);
  EXPECT_NE(boxes[0].id, boxes[1].id);
}

TEST(MissedDetection, AnObjectDetectedOnceHasZeroVelocity) {
  MissedDetectionCompensation compensation{without_growth()};
  static_cast<void>(compensation.update(detected({person(10)})));
  const auto boxes = compensation.update(missed());
  EXPECT_EQ(left_edge(boxes), 10.0);
  EXPECT_TRUE(boxes.front().compensated);
}

TEST(MissedDetection, VelocityIsWeightedByEq4) {
  MissedDetectionCompensation compensation{without_growth()};
  static_cast<void>(compensation.update(detected({person(0)})));
  static_cast<void>(compensation.update(detected({person(8)})));   // v = 8,  weighted (8 + 0) / 2 = 4
  static_cast<void>(compensation.update(detected({person(20)})));  // v = 12, weighted (12 + 4) / 2 = 8
  static_cast<void>(compensation.update(detected({person(23)})));  // v = 3,  weighted (3 + 8) / 2 = 5.5
  EXPECT_DOUBLE_EQ(left_edge(compensation.update(missed())), 28.5);
  EXPECT_DOUBLE_EQ(left_edge(compensation.update(missed())), 34.0);
}

TEST(MissedDetection, VelocityIsPerFrameAcrossAGap) {
  MissedDetectionCompensation compensation{without_growth()};
  static_cast<void>(compensation.update(detected({person(0)})));
  static_cast<void>(compensation.update(missed()));
  static_cast<void>(compensation.update(skipped()));
  static_cast<void>(compensation.update(detected({person(24)})));  // 24 px in 3 frames: v = 8, weighted 4
  EXPECT_DOUBLE_EQ(left_edge(compensation.update(missed())), 28.0);
}

TEST(MissedDetection, KeepsTheIdOfAnObject) {
  MissedDetectionCompensation compensation{without_growth()};
  const auto first = compensation.update(detected({person(0), person(400)}));
  const auto predicted = compensation.update(missed());
  const auto again = compensation.update(detected({person(395), person(5)}));  // in another order
  ASSERT_EQ(again.size(), 2U);
  EXPECT_EQ(predicted[0].id, first[0].id);
  EXPECT_EQ(again[0].id, first[1].id);
  EXPECT_EQ(again[1].id, first[0].id);
}

TEST(MissedDetection, PredictsAMissedObjectBesideADetectedOne) {
  MissedDetectionCompensation compensation{without_growth()};
  const auto first = compensation.update(detected({person(0), person(400)}));
  const auto boxes = compensation.update(detected({person(400)}));
  ASSERT_EQ(boxes.size(), 2U);
  EXPECT_FALSE(boxes[0].compensated);
  EXPECT_TRUE(boxes[1].compensated);
  EXPECT_EQ(boxes[1].id, first[0].id);
}

TEST(MissedDetection, PredictedBoxesGrowOnEverySide) {
  DynamicConfig config = without_growth();
  config.growth_px_per_miss = 10.0;
  MissedDetectionCompensation compensation{config};
  static_cast<void>(compensation.update(detected({person(100)})));
  static_cast<void>(compensation.update(missed()));
  const Box box = compensation.update(missed()).front().box;  // 2 * 10 px
  EXPECT_EQ(box.x_min, 80.0);
  EXPECT_EQ(box.y_min, 30.0);
  EXPECT_EQ(box.x_max, 220.0);
  EXPECT_EQ(box.y_max, 270.0);
  EXPECT_EQ(left_edge(compensation.update(detected({person(100)}))), 100.0) << "a detected box is not grown";
}

TEST(MissedDetection, AbandonsAnObjectAfterTooManyMisses) {
  DynamicConfig config = without_growth();
  config.max_missed_frames = 3;
  MissedDetectionCompensation compensation{config};
  static_cast<void>(compensation.update(detected({person(0)})));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(compensation.update(missed()).size(), 1U) << i;
  EXPECT_TRUE(compensation.update(missed()).empty());
}

TEST(MissedDetection, ADetectionResetsTheCountOfMisses) {
  DynamicConfig config = without_growth();
  config.max_missed_frames = 1;
  MissedDetectionCompensation compensation{config};
  for (int i = 0; i < 4; ++i) {
    static_cast<void>(compensation.update(detected({person(0)})));
    EXPECT_EQ(compensation.update(missed()).size(), 1U) << i;
  }
}

TEST(MissedDetection, SkippedFramesAreCountedSeparately) {
  DynamicConfig config = without_growth();
  config.max_missed_frames = 1;
  config.max_skipped_frames = 4;
  MissedDetectionCompensation compensation{config};
  static_cast<void>(compensation.update(detected({person(0)})));
  EXPECT_EQ(compensation.update(skipped()).size(), 1U);
  EXPECT_EQ(compensation.update(late_set()).size(), 1U);
  EXPECT_EQ(compensation.update(missed()).size(), 1U);
  EXPECT_EQ(compensation.update(skipped()).size(), 1U);
  EXPECT_EQ(compensation.update(late_set()).size(), 1U);
  EXPECT_TRUE(compensation.update(skipped()).empty());  // the fifth
}

TEST(MissedDetection, IgnoresTheBoxesOfALateSet) {
  MissedDetectionCompensation compensation{without_growth()};
  DetectionSet late = late_set();
  late.detections = {person(0)};
  EXPECT_TRUE(compensation.update(late).empty());
}

TEST(MissedDetection, IgnoresClassesThatAreNotConfigured) {
  MissedDetectionCompensation compensation{without_growth()};
  Detection chair = person(0);
  chair.class_name = "chair";
  EXPECT_EQ(left_edge(compensation.update(detected({chair, person(50)}))), 50.0);
  EXPECT_EQ(left_edge(compensation.update(missed())), 50.0);
}

TEST(MissedDetection, IgnoresInvertedBoxes) {
  MissedDetectionCompensation compensation{without_growth()};
  Detection inverted = person(0);
  std::swap(inverted.box.x_min, inverted.box.x_max);
  EXPECT_TRUE(compensation.update(detected({inverted})).empty());
}

TEST(MissedDetection, ReturnsDetectionsOnlyIfDisabled) {
  DynamicConfig config = without_growth();
  config.missed_detection = false;
  MissedDetectionCompensation compensation{config};
  EXPECT_EQ(compensation.update(detected({person(0)})).size(), 1U);
  EXPECT_TRUE(compensation.update(missed()).empty());
  EXPECT_TRUE(compensation.update(skipped()).empty());
}

TEST(MissedDetection, ResetRemovesAllObjects) {
  MissedDetectionCompensation compensation{without_growth()};
  const auto before = compensation.update(detected({person(0)}));
  compensation.reset();
  EXPECT_TRUE(compensation.update(missed()).empty());
  EXPECT_NE(compensation.update(detected({person(0)})).front().id, before.front().id);
}

}  // namespace
}  // namespace stillpoint
