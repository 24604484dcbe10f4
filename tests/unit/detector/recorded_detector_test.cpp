// SPDX-License-Identifier: BSD-3-Clause
#include "core/detector/playback_detectors.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/unit/detector/blank_frame.h"

namespace stillpoint {
namespace {

constexpr double kTolerance_s = 0.016;

/// A set `shift_s` after frame `id`, with one box of width `width`.
DetectionSet set_near(std::int64_t id, double shift_s, double width) {
  return {.t = after(blank_frame(id).t, shift_s),
          .state = DetectionState::kPresent,
          .detections = {{.class_name = "person",
                          .score = 0.8,
                          .box = {.x_min = 10, .y_min = 10, .x_max = 10 + width, .y_max = 100}}}};
}

double width_of(const DetectionSet& set) {
  EXPECT_EQ(set.detections.size(), 1U);
  return set.detections.empty() ? 0.0 : set.detections[0].box.x_max - set.detections[0].box.x_min;
}

TEST(RecordedDetector, FindsTheSetWithTheExactTimestamp) {
  const std::vector sets = {set_near(0, 0.0, 20), set_near(1, 0.0, 30), set_near(2, 0.0, 40)};
  RecordedDetector detector(sets, kTolerance_s);
  const DetectionSet found = detector.detect(blank_frame(1));
  EXPECT_EQ(found.state, DetectionState::kPresent);
  EXPECT_EQ(found.t, blank_frame(1).t);
  EXPECT_EQ(width_of(found), 30.0);
}

TEST(RecordedDetector, UsesTheNearestSetWithinTheTolerance) {
  const std::vector sets = {set_near(1, -0.012, 20), set_near(1, 0.010, 30)};
  RecordedDetector detector(sets, kTolerance_s);
  const DetectionSet found = detector.detect(blank_frame(1));
  EXPECT_EQ(width_of(found), 30.0);
  EXPECT_EQ(found.t, blank_frame(1).t);
  EXPECT_EQ(width_of(detector.detect(blank_frame(1))), 30.0);
}

TEST(RecordedDetector, ReturnsNoneOutsideTheTolerance) {
  const std::vector sets = {set_near(1, 0.0, 20)};
  RecordedDetector detector(sets, kTolerance_s);
  for (const std::int64_t id : {0, 2, 100}) {
    EXPECT_EQ(detector.detect(blank_frame(id)).state, DetectionState::kNone) << id;
  }
  EXPECT_EQ(detector.counters().skipped, 3);
  EXPECT_EQ(detector.counters().unrecorded, 3);
  EXPECT_EQ(detector.counters().processed, 0);
}

TEST(RecordedDetector, WorksWithoutAnyBoxes) {
  RecordedDetector detector({}, kTolerance_s);
  EXPECT_EQ(detector.detect(blank_frame(0)).state, DetectionState::kNone);
}

TEST(RecordedDetector, ReturnsAnEmptyRecordedSet) {
  const std::vector sets = {DetectionSet{.t = blank_frame(0).t, .state = DetectionState::kPresent}};
  RecordedDetector detector(sets, kTolerance_s);
  const DetectionSet found = detector.detect(blank_frame(0));
  EXPECT_EQ(found.state, DetectionState::kPresent);
  EXPECT_TRUE(found.detections.empty());
}

TEST(RecordedDetector, ReturnsARecordedLateSet) {
  const std::vector sets = {DetectionSet{.t = blank_frame(0).t, .state = DetectionState::kLate}};
  RecordedDetector detector(sets, kTolerance_s);
  EXPECT_EQ(detector.detect(blank_frame(0)).state, DetectionState::kLate);
  EXPECT_EQ(detector.counters().unrecorded, 0);
}

TEST(RecordedDetector, ClipsBoxesToTheImage) {
  const std::vector sets = {set_near(0, 0.0, 5000)};
  RecordedDetector detector(sets, kTolerance_s);
  EXPECT_EQ(detector.detect(blank_frame(0)).detections.at(0).box.x_max, kBlankWidth - 1);
  EXPECT_EQ(detector.counters().clipped, 1);
}

TEST(RecordedDetector, RejectsSetsOutOfOrder) {
  const std::vector sets = {set_near(2, 0.0, 20), set_near(1, 0.0, 20)};
  expect_input_error([&] { RecordedDetector(sets, kTolerance_s); }, {"recorded detections", "sort"});
}

}  // namespace
}  // namespace stillpoint
