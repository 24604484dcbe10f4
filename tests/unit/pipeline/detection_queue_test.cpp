// SPDX-License-Identifier: BSD-3-Clause
// Detections of a detector that is slower than the camera, in real-time mode.
#include "core/pipeline/runners/pacing.h"

#include <gtest/gtest.h>

#include <thread>

namespace stillpoint {
namespace {

using std::chrono::milliseconds;

DetectionJob detections_at(double t) {
  return {.set = {.t = from_seconds(t), .state = DetectionState::kPresent, .detections = {}}, .timing = {}};
}

TEST(DetectionQueue, AreThoseOfTheFrameIfInTime) {
  DetectionQueue queue;
  queue.put(detections_at(1.0));
  const DetectionJob taken = queue.take(from_seconds(1.0), milliseconds(0), 0.1);
  EXPECT_EQ(taken.set.state, DetectionState::kPresent);
  EXPECT_EQ(taken.set.t, from_seconds(1.0));
}

TEST(DetectionQueue, AreThoseOfAnEarlierFrameAtMostOnce) {
  DetectionQueue queue;
  queue.put(detections_at(1.0));
  EXPECT_EQ(queue.take(from_seconds(1.05), milliseconds(0), 0.1).set.state, DetectionState::kPresent);
  EXPECT_EQ(queue.take(from_seconds(1.08), milliseconds(0), 0.1).set.state, DetectionState::kLate);
}

TEST(DetectionQueue, AreLateIfTooOld) {
  DetectionQueue queue;
  queue.put(detections_at(1.0));
  const DetectionJob taken = queue.take(from_seconds(1.2), milliseconds(0), 0.1);
  EXPECT_EQ(taken.set.state, DetectionState::kLate);
  EXPECT_EQ(taken.set.t, from_seconds(1.2));
}

TEST(DetectionQueue, OfLaterFramesAreKeptForThem) {
  DetectionQueue queue;
  queue.put(detections_at(1.033));
  queue.put(detections_at(1.0));
  EXPECT_EQ(queue.take(from_seconds(1.0), milliseconds(0), 0.1).set.t, from_seconds(1.0));
  const DetectionJob next = queue.take(from_seconds(1.033), milliseconds(0), 0.1);
  EXPECT_EQ(next.set.state, DetectionState::kPresent);
  EXPECT_EQ(next.set.t, from_seconds(1.033));
}

TEST(DetectionQueue, OfLaterFramesAreNotUsedEarlier) {
  DetectionQueue queue;
  queue.put(detections_at(1.033));
  EXPECT_EQ(queue.take(from_seconds(1.0), milliseconds(0), 0.1).set.state, DetectionState::kLate);
}

TEST(DetectionQueue, AreAwaitedUntilTheTimeout) {
  DetectionQueue queue;
  const std::jthread detector([&queue] { queue.put(detections_at(1.0)); });
  EXPECT_EQ(queue.take(from_seconds(1.0), std::chrono::seconds(10), 0.1).set.state, DetectionState::kPresent);
}

}  // namespace
}  // namespace stillpoint
