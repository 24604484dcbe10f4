// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/tracking_monitor.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

/// Of visual odometry at a frame rate: one located frame, then frames with features that locate none.
/// @return time from the first of those to the first frame of a new segment [s]
double patience_s(double rate_hz, int features) {
  TrackingMonitor monitor({.uses_imu = false});
  Window window;
  window.frames.emplace_back();
  const VisionAssessment good{.features = 100, .inliers = 100, .sigma_m = 0.001, .sigma_rad = 0.001};
  static_cast<void>(
      monitor.update({.features = 100, .has_start = true, .located = true, .vision = good}, window));
  for (int i = 0; i < 1000; ++i) {
    const Timestamp t = from_seconds((i + 1) / rate_hz);
    static_cast<void>(monitor.update({.t = t, .features = features, .has_start = true}, window));
    if (monitor.segment() == 1) return i / rate_hz;
  }
  return 1000.0 / rate_hz;
}

TEST(TrackingMonitor, ANewSegmentBeginsAfterASecondWithoutTheMap) {
  EXPECT_NEAR(patience_s(30.0, 50), 1.0, 0.05);
}

/// After a second a camera of 4 Hz has tried four frames only.
TEST(TrackingMonitor, ANewSegmentBeginsAfterTenFramesAtLowRates) {
  EXPECT_NEAR(patience_s(4.0, 50), 9 / 4.0, 1e-6);
}

TEST(TrackingMonitor, WithoutAViewNoSegmentBegins) { EXPECT_GT(patience_s(30.0, 5), 30.0); }

}  // namespace
}  // namespace stillpoint
