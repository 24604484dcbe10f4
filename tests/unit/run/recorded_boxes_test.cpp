// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/odometry_run.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

/// Frames at 1 and 2 s, and boxes at the given time in memory and in the folder.
datasets::SequenceInfo sequence_with_boxes_at(const TemporaryFolder& folder, double t) {
  static_cast<void>(folder.write("detections.txt", ""));
  datasets::SequenceInfo info;
  info.folder = folder.path();
  info.frame_times = {from_seconds(1.0), from_seconds(2.0)};
  info.detections = {{.t = from_seconds(t), .state = DetectionState::kPresent, .detections = {}}};
  return info;
}

TEST(RecordedBoxes, MustBelongToAtLeastOneFrame) {
  const TemporaryFolder folder;
  EXPECT_NO_THROW(require_recorded_boxes(OdometryConfig{}, sequence_with_boxes_at(folder, 1.984)));
  expect_input_error([&] { require_recorded_boxes(OdometryConfig{}, sequence_with_boxes_at(folder, 1.9)); },
                     {"detections.txt: none of its 1 time stamps is within 0.016 s of a frame",
                      "stillpoint detect", "--set detector.kind=none"});
}

TEST(RecordedBoxes, MustExistAsAFile) {
  const TemporaryFolder folder;
  expect_input_error([&] { require_recorded_boxes(OdometryConfig{}, folder.path()); },
                     {"detections.txt: does not exist"});
}

TEST(RecordedBoxes, AreNotRequiredWithoutDetectorOrMask) {
  const TemporaryFolder folder;
  OdometryConfig config;
  config.detector.kind = DetectorKind::kNetwork;
  EXPECT_NO_THROW(require_recorded_boxes(config, folder.path()));
  config = {};
  config.dynamic.mask = DynamicMask::kOff;
  EXPECT_NO_THROW(require_recorded_boxes(config, folder.path()));
}

}  // namespace
}  // namespace stillpoint::bench
