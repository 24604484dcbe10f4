// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/depth_monitor.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/backend/estimator.h"
#include "tests/support/random.h"
#include "tests/support/simulated/simulated_motion.h"
#include "tests/support/simulated/simulated_window.h"

namespace stillpoint {
namespace {

constexpr double kDepthFocal_px = 400.0;

Window window_with_depth_factor(double factor) {
  SimulatedWindowOptions options{.frames = 14, .points = 200};
  Window window = simulated_window(options);
  for (Landmark& landmark : window.landmarks) landmark.observations.back().depth *= factor;
  return window;
}

TEST(DepthScale, IsThatOfTheNewestFrame) {
  DepthScale scale(kDepthFocal_px);
  EXPECT_NEAR(scale.of_newest(window_with_depth_factor(1.0)).value(), 1.0, 0.01);
  EXPECT_NEAR(scale.of_newest(window_with_depth_factor(0.9)).value(), 0.9, 0.01);
}

/// The sensor is consistent with its estimated scale.
TEST(DepthScale, IsRelativeToTheEstimatedOne) {
  Window window = window_with_depth_factor(0.9);
  window.depth_scale = 0.9;
  EXPECT_NEAR(DepthScale(kDepthFocal_px).of_newest(window).value(), 1.0, 0.01);
}

/// A person who stays in front of a moving camera is not where he is predicted, and all of his points are
/// nearer by the same factor. His depth was taken for that of a sensor of another scale.
TEST(DepthScale, IsNotThatOfAPersonBeforeTheCamera) {
  Window window = window_with_depth_factor(1.0);
  std::size_t k = 0;
  for (Landmark& landmark : window.landmarks) {
    Observation& observation = landmark.observations.back();
    if (++k % 3 == 0) continue;
    observation.bearing.x() += 20.0 / kDepthFocal_px;
    observation.depth *= 0.9;
  }
  EXPECT_NEAR(DepthScale(kDepthFocal_px).of_newest(window).value(), 1.0, 0.01);
  window.frames.back().imu_is_reliable = false;
  EXPECT_NEAR(DepthScale(kDepthFocal_px).of_newest(window).value(), 0.9, 0.01);
}

/// Whether the newest depths are rejected, measured `seconds` after the start with a scale of the rig that is
/// not known.
bool rejects(DepthMonitor& monitor, double factor, double seconds) {
  Window window = window_with_depth_factor(factor);
  window.agrees_with_rig.depth_scale = true;
  window.frames.back().state.t = after(Timestamp{}, seconds);
  monitor.update(std::nullopt, window);
  return !DepthScale(kDepthFocal_px).of_newest(window);
}

TEST(DepthMonitor, RejectsAJumpOfAScaleThatIsNotKnown) {
  DepthMonitor monitor(0.04, kDepthFocal_px);
  EXPECT_FALSE(rejects(monitor, 1.0, 0.0));
  EXPECT_FALSE(rejects(monitor, 1.0, 1.0));
  EXPECT_TRUE(rejects(monitor, 0.9, 1.1));
  EXPECT_TRUE(rejects(monitor, 0.9, 4.0));
  EXPECT_FALSE(rejects(monitor, 1.0, 4.1));
}

/// The inertial scale pulls the landmarks away from a scale that was wrong from the first frame on.
TEST(DepthMonitor, UsesAScaleThatIsNotKnownAndMoves) {
  DepthMonitor monitor(0.04, kDepthFocal_px);
  EXPECT_FALSE(rejects(monitor, 0.9, 0.0));
  EXPECT_FALSE(rejects(monitor, 1.0, 0.1));
  EXPECT_FALSE(rejects(monitor, 0.97, 1.5));
  EXPECT_FALSE(rejects(monitor, 0.94, 1.6));
}

/// Frame `i` of a camera at 5 Hz before a wall that is 2.7 and 3 m away in turn. A track lasts for
/// three frames; a third of them begin in each.
TrackedFrame frame_before_a_wall(int i) {
  const Camera camera = SimulatedMotion::rig().camera;
  const double distance_m = i % 2 == 0 ? 3.0 : 2.7;
  Random places(3);
  TrackedFrame frame{.id = i, .t = from_seconds(0.2 * i)};
  for (int k = 0; k < 90; ++k) {
    const Eigen::Vector3d p_c =
        places.uniform3({-1.2, -0.9, 0.0}, {1.2, 0.9, 0.0}) + Eigen::Vector3d(0.0, 0.0, distance_m);
    TrackedFeature feature{.id = 90 * ((i + k) / 3) + k, .pixel = camera.project(p_c), .depth = p_c.z()};
    feature.bearing = camera.unproject(feature.pixel);
    frame.features.push_back(feature);
  }
  std::ranges::sort(frame.features, {}, &TrackedFeature::id);
  return frame;
}

/// At constant velocity the wall would be a tenth nearer or farther than it is: all depth from the third
/// frame on was rejected. In a hand that also turns, the camera was then lost.
TEST(DepthMonitor, UsesTheDepthOfACameraThatTurnsBackWithoutAnImu) {
  ImuConfig no_imu;
  no_imu.enabled = false;
  Estimator estimator(BackendConfig{}, no_imu, SimulatedMotion::rig(), 1);
  for (int i = 0; i < 20; ++i) {
    const OdometryUpdate& update = estimator.process(frame_before_a_wall(i));
    EXPECT_EQ(update.status, OdometryStatus::kTracking) << i;
    EXPECT_EQ(update.counters.depth_landmarks, update.counters.window_landmarks) << i;
  }
}

}  // namespace
}  // namespace stillpoint
