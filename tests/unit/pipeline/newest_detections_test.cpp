// SPDX-License-Identifier: BSD-3-Clause
// A detector that is slower than the camera, as the optimisation meets it in realtime.
#include "core/pipeline/newest_detections.h"

#include <gtest/gtest.h>

#include <thread>

namespace stillpoint {
namespace {

using std::chrono::milliseconds;

DetectionOnWay found_at(double t) {
  return {.set = {.t = from_seconds(t), .state = DetectionState::kPresent, .detections = {}}, .search = {}};
}

TEST(NewestDetections, AreThePicturesOwnWhereTheyAreInTime) {
  NewestDetections newest;
  newest.put(found_at(1.0));
  const DetectionOnWay taken = newest.take(from_seconds(1.0), milliseconds(0), 0.1);
  EXPECT_EQ(taken.set.state, DetectionState::kPresent);
  EXPECT_EQ(taken.set.t, from_seconds(1.0));
}

TEST(NewestDetections, AreThoseOfAnEarlierPictureOnce) {
  NewestDetections newest;
  newest.put(found_at(1.0));
  EXPECT_EQ(newest.take(from_seconds(1.05), milliseconds(0), 0.1).set.state, DetectionState::kPresent);
  EXPECT_EQ(newest.take(from_seconds(1.08), milliseconds(0), 0.1).set.state, DetectionState::kLate);
}

TEST(NewestDetections, AreLateWhenTooOld) {
  NewestDetections newest;
  newest.put(found_at(1.0));
  const DetectionOnWay taken = newest.take(from_seconds(1.2), milliseconds(0), 0.1);
  EXPECT_EQ(taken.set.state, DetectionState::kLate);
  EXPECT_EQ(taken.set.t, from_seconds(1.2));
}

TEST(NewestDetections, AreWaitedForALittle) {
  NewestDetections newest;
  const std::jthread detector([&newest] { newest.put(found_at(1.0)); });
  EXPECT_EQ(newest.take(from_seconds(1.0), std::chrono::seconds(10), 0.1).set.state,
            DetectionState::kPresent);
}

}  // namespace
}  // namespace stillpoint
