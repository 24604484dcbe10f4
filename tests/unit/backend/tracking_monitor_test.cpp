// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/tracking_monitor.h"

#include <gtest/gtest.h>

#include "tests/support/simulated/window_world.h"

namespace stillpoint {
namespace {

using enum OdometryStatus;

constexpr double kUpdateInterval_s = 0.1;

/// Vision locates the camera, and inertial data is sound.
FrameEvidence sound_frame() {
  return {.features = 100,
          .has_start = true,
          .inertial = true,
          .located = true,
          .vision = {.features = 60, .inliers = 50, .sigma_m = 1e-3, .sigma_rad = 1e-3}};
}

/// No feature.
FrameEvidence blank_frame() { return {.has_start = true, .inertial = true}; }

struct MonitoredRun {
  TrackingMonitor monitor{MonitorOptions{}};
  Window window = visual_window(3, 40);
  double t = 0.0;

  /// @return whether the window must be cleared
  bool update(FrameEvidence evidence) {
    evidence.t = after({}, t += kUpdateInterval_s);
    window.frames.back().state.t = evidence.t;
    return monitor.update(evidence, window);
  }
  void expect(OdometryStatus status, StatusReason reason) const {
    EXPECT_EQ(monitor.status(), status);
    EXPECT_EQ(monitor.reason(), reason);
  }
};

MonitoredRun tracking_run() {
  MonitoredRun run;
  EXPECT_FALSE(run.update(sound_frame()));
  run.expect(kTracking, StatusReason::kNone);
  return run;
}

TEST(TrackingMonitor, StartsWhenVisionLocatesTheCameraAndScaleAndGravityAreKnown) {
  MonitoredRun run;
  FrameEvidence evidence = sound_frame();
  evidence.has_start = false;
  EXPECT_FALSE(run.update(evidence));
  run.expect(kInitializing, StatusReason::kNone);
  EXPECT_FALSE(run.update(blank_frame()));
  run.expect(kInitializing, StatusReason::kNone);
  EXPECT_FALSE(run.update(sound_frame()));
  run.expect(kTracking, StatusReason::kNone);
}

TEST(TrackingMonitor, IsDegradedForEachReasonAndRecovers) {
  MonitoredRun run = tracking_run();
  const auto expect_degraded = [&](const FrameEvidence& evidence, StatusReason reason) {
    EXPECT_FALSE(run.update(evidence));
    run.expect(kDegraded, reason);
    EXPECT_FALSE(run.update(sound_frame()));
    run.expect(kTracking, StatusReason::kNone);
  };
  FrameEvidence evidence = sound_frame();
  evidence.inertial = false;
  expect_degraded(evidence, StatusReason::kNoInertialStart);
  evidence = sound_frame();
  evidence.imu_defect = StatusReason::kImuSaturated;
  expect_degraded(evidence, StatusReason::kImuSaturated);
  evidence = sound_frame();
  evidence.contradiction = true;
  expect_degraded(evidence, StatusReason::kImuInconsistent);
  evidence = sound_frame();
  evidence.vision.inliers = 14;
  expect_degraded(evidence, StatusReason::kFewFeatures);
  evidence = sound_frame();
  evidence.vision.sigma_m = 0.2;
  expect_degraded(evidence, StatusReason::kWeakGeometry);
}

TEST(TrackingMonitor, WithoutVisionInertialDataIsUsedForSixSeconds) {
  MonitoredRun run = tracking_run();
  for (int i = 0; i < 60; ++i) {
    EXPECT_FALSE(run.update(blank_frame()));
    run.expect(kDeadReckoning, StatusReason::kFewFeatures);
  }
  EXPECT_TRUE(run.update(blank_frame()));
  run.expect(kLost, StatusReason::kUncertain);
  EXPECT_TRUE(run.monitor.awaits_map());
}

TEST(TrackingMonitor, DeadReckoningEndsWhenItsUncertaintyHasGrownByHalfAMeter) {
  MonitoredRun run = tracking_run();
  FrameEvidence evidence = blank_frame();
  evidence.covariance(0, 0) = 0.45 * 0.45;
  EXPECT_FALSE(run.update(evidence));
  evidence.covariance(0, 0) = 0.55 * 0.55;
  EXPECT_TRUE(run.update(evidence));
  run.expect(kLost, StatusReason::kUncertain);
}

TEST(TrackingMonitor, IsLostWithoutVisionAndInertialData) {
  MonitoredRun run = tracking_run();
  FrameEvidence evidence = blank_frame();
  evidence.imu_defect = StatusReason::kImuGap;
  EXPECT_FALSE(run.update(evidence));
  run.expect(kLost, StatusReason::kImuGap);
  EXPECT_FALSE(run.update(sound_frame()));
  run.expect(kRelocated, StatusReason::kMapMatched);
  EXPECT_FALSE(run.update(sound_frame()));
  run.expect(kTracking, StatusReason::kNone);
}

/// The landmarks of a window that was dead reckoned have ended: it would stay lost, though the view is back.
TEST(TrackingMonitor, IsLostUntilTheMapLocatesItIfInertialDataFailsWhileDeadReckoning) {
  MonitoredRun run = tracking_run();
  EXPECT_FALSE(run.update(blank_frame()));
  run.expect(kDeadReckoning, StatusReason::kFewFeatures);
  FrameEvidence evidence = blank_frame();
  evidence.imu_defect = StatusReason::kImuSaturated;
  EXPECT_TRUE(run.update(evidence));
  run.expect(kLost, StatusReason::kImuSaturated);
  EXPECT_TRUE(run.monitor.awaits_map());
  EXPECT_FALSE(run.update(evidence));
}

TEST(TrackingMonitor, BridgesARepeatedImageForThreeFramesOfThirtyHertz) {
  MonitoredRun run = tracking_run();
  FrameEvidence evidence{.bridged = true, .has_start = true};
  EXPECT_FALSE(run.update(evidence));
  run.expect(kDegraded, StatusReason::kRepeatedImage);
  EXPECT_FALSE(run.update(evidence));  // 0.2 s after the last image
  run.expect(kLost, StatusReason::kFewFeatures);
}

TEST(TrackingMonitor, ADivergedEstimateIsLostUntilTheMapConfirmsAPose) {
  MonitoredRun run = tracking_run();
  FrameEvidence evidence = sound_frame();
  evidence.failure = StatusReason::kDiverged;
  EXPECT_FALSE(run.update(evidence));
  run.expect(kLost, StatusReason::kDiverged);
  EXPECT_TRUE(run.monitor.awaits_map());
  EXPECT_FALSE(run.update(sound_frame()));
  run.expect(kLost, StatusReason::kDiverged);
  run.monitor.relocated();
  EXPECT_FALSE(run.update(sound_frame()));
  run.expect(kRelocated, StatusReason::kMapMatched);
  EXPECT_FALSE(run.monitor.awaits_map());
}

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

/// The features of the newest frame of the window.
TrackedFrame frame_of(const Window& window, int count) {
  TrackedFrame frame{.t = window.frames.back().state.t};
  for (const Landmark& landmark : window.landmarks) {
    if (landmark.id >= count) continue;
    frame.features.push_back({.id = landmark.id, .bearing = landmark.observations.back().bearing});
  }
  return frame;
}

TEST(TrustedMap, LocatesTheCameraByTwelveFeaturesOrMore) {
  const Window window = visual_window(3, 40);
  TrustedMap map;
  map.update(window, Matrix6::Zero());
  const Pose predicted = window.T_w_c(1);
  for (const int count : {11, 12}) {
    const auto found = map.locate(frame_of(window, count), predicted, {.inlier_threshold = 0.01}, 0.003);
    ASSERT_EQ(found.has_value(), count == 12);
    if (found) {
      EXPECT_LT((found->T_w_f.p - window.T_w_c(2).p).norm(), 1e-4);
    }
  }
}

TEST(TrustedMap, HalfOfTheFeaturesMustAgree) {
  const Window window = visual_window(3, 40);
  TrustedMap map;
  map.update(window, Matrix6::Zero());
  for (const int moved : {16, 24}) {
    TrackedFrame frame = frame_of(window, 40);
    for (int i = 0; i < moved; ++i)
      frame.features[static_cast<std::size_t>(i)].bearing += Eigen::Vector2d(0.1 + 0.01 * i, 0.02 * i);
    EXPECT_EQ(map.locate(frame, window.T_w_c(2), {.inlier_threshold = 0.01}, 0.003).has_value(), moved == 16);
  }
}

TEST(TrustedMap, ReturnsToAVersionFromBeforeADivergence) {
  Window window = visual_window(3, 40);
  TrustedMap map;
  const Pose truth = window.T_w_c(2);
  const TrackedFrame frame = frame_of(window, 40);
  for (const double t : {0.2, 0.8}) {
    window.frames.back().state.t = after({}, t);
    map.update(window, Matrix6::Zero());
  }
  for (WindowFrame& moved : window.frames) moved.state.T_w_b.p.x() += 3.0;
  window.frames.back().state.t = after({}, 1.0);
  map.update(window, Matrix6::Zero());
  map.discard_newest();
  const auto found = map.locate(frame, truth, {.inlier_threshold = 0.01}, 0.003);
  ASSERT_TRUE(found);
  EXPECT_LT((found->T_w_f.p - truth.p).norm(), 1e-4);
}

}  // namespace
}  // namespace stillpoint
