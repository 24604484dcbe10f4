// SPDX-License-Identifier: BSD-3-Clause
// Detections of a detector that is slower than the camera, in real-time mode.
#include "core/pipeline/runners/newest_detections.h"

#include <gtest/gtest.h>

#include <thread>

namespace stillpoint {
namespace {

using std::chrono::milliseconds;

DetectionJob detections_at(double t) {
  return {.set = {.t = from_seconds(t), .state = DetectionState::kPresent, .detections = {}}, .timing = {}};
}

TEST(NewestDetections, AreThoseOfTheFrameIfInTime) {
  NewestDetections newest;
  newest.put(detections_at(1.0));
  const DetectionJob taken = newest.take(from_seconds(1.0), milliseconds(0), 0.1);
  EXPECT_EQ(taken.set.state, DetectionState::kPresent);
  EXPECT_EQ(taken.set.t, from_seconds(1.0));
}

TEST(NewestDetections, AreThoseOfAnEarlierFrameAtMostOnce) {
  NewestDetections newest;
  newest.put(detections_at(1.0));
  EXPECT_EQ(newest.take(from_seconds(1.05), milliseconds(0), 0.1).set.state, DetectionState::kPresent);
  EXPECT_EQ(newest.take(from_seconds(1.08), milliseconds(0), 0.1).set.state, DetectionState::kLate);
}

TEST(NewestDetections, AreLateIfTooOld) {
  NewestDetections newest;
  newest.put(detections_at(1.0));
  const DetectionJob taken = newest.take(from_seconds(1.2), milliseconds(0), 0.1);
  EXPECT_EQ(taken.set.state, DetectionState::kLate);
  EXPECT_EQ(taken.set.t, from_seconds(1.2));
}

TEST(NewestDetections, AreAwaitedUntilTheTimeout) {
  NewestDetections newest;
  const std::jthread detector([&newest] { newest.put(detections_at(1.0)); });
  EXPECT_EQ(newest.take(from_seconds(1.0), std::chrono::seconds(10), 0.1).set.state,
            DetectionState::kPresent);
}

}  // namespace
}  // namespace stillpoint
