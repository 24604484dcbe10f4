// SPDX-License-Identifier: BSD-3-Clause
// The parts of the estimator alone: SlidingWindow, WindowStart and SensorMonitor.
#include <gtest/gtest.h>

#include <limits>

#include "core/backend/health/sensor_monitor.h"
#include "core/backend/sliding_window.h"
#include "core/backend/start/initial_prior.h"
#include "core/backend/start/window_start.h"
#include "tests/support/simulated/simulated_motion.h"
#include "tests/support/simulated/window_world.h"

namespace stillpoint {
namespace {

ImuConfig no_imu() {
  ImuConfig config;
  config.enabled = false;
  return config;
}

/// A window of `frames` frames with its initial prior.
SlidingWindow sliding_window(int frames, const BackendConfig& config) {
  Window window = visual_window(frames, 40);
  window.prior = initial_prior(window, config);
  window.calibration = calibration_prior(window, config);
  return {config, SimulatedMotion::rig(), 1, std::move(window)};
}

BackendConfig short_window() {
  BackendConfig config;
  config.window_size = 4;
  config.solver = WindowSolverKind::kSchur;
  config.depth.usage = DepthUsage::kWeighted;
  return config;
}

TEST(SlidingWindow, ReadmitsAClearedLandmarkWithoutItsDepth) {
  Window window = visual_window(3, 4);
  const DynamicLabel moving{.id = 2, .label = LabelClass::kDynamicMotion}, cleared{.id = 2};
  mark_dynamic({&moving, 1}, window);
  EXPECT_TRUE(window.landmarks[2].dynamic);
  EXPECT_FALSE(window.landmarks[1].dynamic);
  mark_dynamic({&cleared, 1}, window);
  EXPECT_FALSE(window.landmarks[2].dynamic);
  EXPECT_EQ(window.landmarks[2].inverse_depth, 0.0);  // it was estimated before the point moved
  EXPECT_GT(window.landmarks[1].inverse_depth, 0.0);
}

TEST(SlidingWindow, DoesNotSlideBeforeItIsFull) {
  SlidingWindow window = sliding_window(4, short_window());  // four states before the newest one are full
  ASSERT_FALSE(window.is_full());
  window.slide();
  EXPECT_EQ(window.states().newest(), 3);
}

TEST(SlidingWindow, ReplacesTheOldestFrameByAPriorIfTheSecondNewestStays) {
  BackendConfig config = short_window();
  config.keyframe_parallax_px = 0.1;  // each frame is a keyframe
  SlidingWindow window = sliding_window(5, config);
  window.choose_keyframe();
  ASSERT_TRUE(window.is_full() && window.keyframe());
  window.slide();
  ASSERT_EQ(window.states().newest(), 3);
  EXPECT_EQ(window.states().frames.front().id, 1);
  EXPECT_FALSE(window.states().prior.empty());
}

TEST(SlidingWindow, LeavesOutTheSecondNewestFrameOtherwise) {
  BackendConfig config = short_window();
  config.keyframe_parallax_px = 200.0;
  config.keyframe_min_shared_ratio = 0.0;
  SlidingWindow window = sliding_window(5, config);
  window.choose_keyframe();
  ASSERT_TRUE(window.is_full() && !window.keyframe());
  window.slide();
  ASSERT_EQ(window.states().newest(), 3);
  EXPECT_EQ(window.states().frames.front().id, 0);
  EXPECT_EQ(window.states().frames.back().id, 4);
}

TEST(WindowStart, FixesTheFirstFrameByPriors) {
  const BackendConfig config = short_window();
  const Rig rig = SimulatedMotion::rig();
  const Calibration calibration(config, false, rig);
  Window window = calibration.calibrated_window();
  WindowStart(config, no_imu(), rig).begin({.id = 7}, calibration, ImuBuffer(), window);
  ASSERT_EQ(window.frames.size(), 1U);
  EXPECT_EQ(window.frames.front().id, 7);
  EXPECT_FALSE(window.prior.empty() || window.calibration.empty());
}

TEST(WindowStart, DoesNotInitializeAShortWindowOrOneWithoutAnImu) {
  const BackendConfig config = short_window();
  const Rig rig = SimulatedMotion::rig();
  const std::unique_ptr<WindowSolver> solver = make_window_solver(config.solver);
  Window window = visual_window(3, 40);
  EXPECT_FALSE(WindowStart(config, {}, rig).initialize(window, *solver));
  window = visual_window(5, 40);
  EXPECT_FALSE(WindowStart(config, no_imu(), rig).initialize(window, *solver));
  EXPECT_FALSE(window.inertial);
}

TEST(WindowStart, KeepsGravityWithItsCovarianceOverARestart) {
  const Calibration calibration(short_window(), true, SimulatedMotion::rig());
  Window before = visual_window(3, 10);
  before.gravity_covariance = 0.01 * Eigen::Matrix2d::Identity();
  const Window after = WindowStart::restarted(before, {0.0, 1.0, -9.7}, calibration);
  EXPECT_TRUE(after.frames.empty() && after.landmarks.empty());
  EXPECT_EQ(after.gravity_w, Eigen::Vector3d(0.0, 1.0, -9.7));
  ASSERT_TRUE(after.gravity_covariance);
  EXPECT_EQ(*after.gravity_covariance, *before.gravity_covariance);
}

class SensorMonitorTest : public testing::Test {
 protected:
  SensorMonitor monitor{short_window(), {}, SimulatedMotion::rig(), 1};
};

TEST_F(SensorMonitorTest, ReplacesTheNoiseOfMissingSamples) {
  monitor.begin_frame({.t = from_seconds(0.5)}, false);
  const std::vector<ImuSample> samples = SimulatedMotion{}.imu(0.1);
  EXPECT_TRUE(monitor.inspect({.samples = samples, .end = samples.back().t}));
  EXPECT_FALSE(monitor.inspect({.samples = std::span(samples).first(1), .end = samples.back().t}));
  const ImuNoise sensor = SimulatedMotion::rig().imu_noise;
  EXPECT_EQ(monitor.imu_noise(true).accel_noise, sensor.accel_noise);
  EXPECT_GT(monitor.imu_noise(false).accel_noise, 100.0 * sensor.accel_noise);
  EXPECT_EQ(monitor.imu_noise(false).accel_walk, sensor.accel_walk);
}

TEST_F(SensorMonitorTest, GivesUpAnImplausibleStateOrAfterThreeFailedSolves) {
  Window window = visual_window(3, 10);
  const NavState before = window.frames.back().state;
  EXPECT_EQ(monitor.failure_of(window, before, 2), StatusReason::kNone);
  EXPECT_EQ(monitor.failure_of(window, before, 3), StatusReason::kSolveFailed);
  window.frames.back().state.gyro_bias.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(monitor.failure_of(window, before, 0), StatusReason::kDiverged);
  window.frames.back().state.gyro_bias.x() = 0.0;
  window.frames.back().state.T_w_b.p.x() += 5.1;
  EXPECT_EQ(monitor.failure_of(window, before, 0), StatusReason::kDiverged);
  window.frames.back().state.T_w_b.p.x() -= 5.1;
  window.prior = initial_prior(window, short_window());
  window.prior.residual(0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(monitor.failure_of(window, before, 0), StatusReason::kDiverged);
}

TEST_F(SensorMonitorTest, TracksOnceTheWindowIsInertialAndVisionLocatesIt) {
  Window window = visual_window(4, 40);
  const std::optional<StateCovariance> no_covariance;
  const auto status = [&](bool located) {
    monitor.begin_frame({.t = window.frames.back().state.t}, false);
    static_cast<void>(monitor.update_status(
        {.located = located, .has_metric_scale = true, .covariance = no_covariance}, window));
    return monitor.status();
  };
  EXPECT_EQ(status(true), OdometryStatus::kInitializing);  // gravity is not known
  window.inertial = true;
  EXPECT_EQ(status(true), OdometryStatus::kTracking);
  EXPECT_EQ(status(false), OdometryStatus::kDeadReckoning);
}

}  // namespace
}  // namespace stillpoint
