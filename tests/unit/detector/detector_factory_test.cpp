// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "core/detector/object_detector.h"
#include "tests/support/expect_input_error.h"
#include "tests/unit/detector/blank_frame.h"

namespace stillpoint {
namespace {

std::vector<DetectionSet> recorded(int frames) {
  std::vector<DetectionSet> sets;
  for (int id = 0; id < frames; ++id)
    sets.push_back({.t = blank_frame(id).t, .state = DetectionState::kPresent, .detections = {}});
  return sets;
}

TEST(MakeObjectDetector, CreatesTheConfiguredDetector) {
  const auto sets = recorded(2);
  DetectorConfig config;
  EXPECT_EQ(make_object_detector(config, {.boxes = sets})->description(), "recorded, 2 frames");
  config.kind = DetectorKind::kNone;
  EXPECT_EQ(make_object_detector(config, {.boxes = sets})->description(), "none");
  config.kind = DetectorKind::kSimulated;
  EXPECT_EQ(make_object_detector(config, {.boxes = sets})->description(),
            "simulated over 2 frames of ground truth boxes");
  config.kind = DetectorKind::kNetwork;
  expect_input_error([&] { static_cast<void>(make_object_detector(config, {.boxes = sets})); },
                     {"detector.names"});
}

TEST(MakeObjectDetector, InjectsFaultsIntoComputedResults) {
  const auto sets = recorded(2);
  const auto silenced = [](DetectionSet set) {
    return DetectionSet{.t = set.t, .state = DetectionState::kNone, .detections = {}};
  };
  DetectorConfig config;
  config.kind = DetectorKind::kSimulated;
  const auto detector = make_object_detector(config, {.boxes = sets, .change = silenced});
  EXPECT_EQ(detector->detect(blank_frame(0)).state, DetectionState::kNone);
  EXPECT_EQ(detector->counters().processed, 1);
  EXPECT_NE(detector->description().find("injected faults"), std::string::npos);
}

TEST(MakeObjectDetector, NoneSkipsEveryFrame) {
  DetectorConfig config;
  config.kind = DetectorKind::kNone;
  const auto detector = make_object_detector(config, {});
  EXPECT_EQ(detector->detect(blank_frame(0)).state, DetectionState::kNone);
  EXPECT_EQ(detector->counters().skipped, 1);
}

TEST(MakeObjectDetector, ProcessesEveryNthFrameOnly) {
  const auto sets = recorded(7);
  DetectorConfig config;
  config.every_n_frames = 3;
  const auto detector = make_object_detector(config, {.boxes = sets});
  std::vector<std::int64_t> processed;
  for (int id = 0; id < 7; ++id) {
    if (detector->detect(blank_frame(id)).state == DetectionState::kPresent) processed.push_back(id);
  }
  EXPECT_EQ(processed, (std::vector<std::int64_t>{0, 3, 6}));
  EXPECT_EQ(detector->counters().processed, 3);
  EXPECT_EQ(detector->counters().skipped, 4);
}

}  // namespace
}  // namespace stillpoint
