// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/standstill.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/backend/estimator.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

constexpr double kRate_hz = 30.0;
constexpr double kStop_s = 3.0;   // the camera rests 1 s later
constexpr double kCover_s = 5.0;  // a person is in front of the camera for 5 s
constexpr double kUncover_s = 10.0;
constexpr int kFirstPersonId = 1000;

SimulatedMotion stopping_motion() {
  return {.pixel_noise_px = 0.5,
          .depth_noise = 0.003,
          .imu_noise = {.gyro_noise = 2e-4, .accel_noise = 2e-3, .gyro_walk = 2e-5, .accel_walk = 2e-4},
          .noisy_imu = true,
          .stop_s = kStop_s};
}

/// Replaces the features in the left 80 % of the image by those of a person 1.2 m away who sways sideways
/// with up to 0.6 m/s.
TrackedFrame covered(TrackedFrame frame, double t, Random& random) {
  const Camera camera = SimulatedMotion::rig().camera;
  const double edge_px = 0.8 * camera.width;
  std::erase_if(frame.features, [&](const TrackedFeature& f) { return f.pixel.x() < edge_px; });
  for (int k = 0; k < 120; ++k) {
    const Eigen::Vector3d p_c(-1.2 + 0.2 * (k % 12) + 0.25 * std::sin(2.4 * t), -0.5 + 0.1 * (k / 12), 1.2);
    Eigen::Vector2d pixel = camera.project(p_c);
    if (pixel.x() >= edge_px || !camera.contains(pixel)) continue;
    pixel += 0.5 * random.normal2();
    frame.features.push_back({.id = kFirstPersonId + k,
                              .pixel = pixel,
                              .bearing = camera.unproject(pixel),
                              .depth = 1.0 / (1.0 / 1.2 + 0.003 * random.normal())});
  }
  return frame;
}

struct StandingRun {
  double drift_m = 0.0;    ///< largest distance from the position before the person appears
  int resting_frames = 0;  ///< while the person is in front of the camera
  int false_rest = 0;      ///< frames in motion that were taken for rest
};

/// Without dynamic feature recognition: all features are used.
StandingRun run_standing(const ZeroVelocityConfig& zero_velocity) {
  BackendConfig config;
  config.rate_hz = 0.0;
  config.solver = WindowSolverKind::kSchur;
  config.gravity = GravityModel::kEstimated;
  config.keyframe_max_interval_s = 0.5;
  config.depth = {.usage = DepthUsage::kWeighted, .outlier_sigmas = 5.0};
  config.initializer.kind = InitializerKind::kInstant;
  config.zero_velocity = zero_velocity;
  const SimulatedMotion motion = stopping_motion();
  Rig rig = SimulatedMotion::rig();
  rig.imu_noise = motion.imu_noise;
  Estimator estimator(config, {}, rig, 1);
  for (const ImuSample& sample : motion.imu(kUncover_s + 1.0)) estimator.add_imu(sample);
  Random random(4);
  StandingRun run;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  for (int i = 0; i < static_cast<int>((kUncover_s + 0.5) * kRate_hz); ++i) {
    const double t = 0.1 + i / kRate_hz;
    const bool is_covered = t >= kCover_s && t < kUncover_s;
    TrackedFrame frame = motion.frame(i, t);
    if (is_covered) frame = covered(std::move(frame), t, random);
    const OdometryUpdate& update = estimator.process(frame);
    if (t < kStop_s + 0.8) run.false_rest += update.counters.at_rest;
    if (t < kCover_s) before = update.state.T_w_b.p;
    if (t < kCover_s) continue;
    run.resting_frames += is_covered && update.counters.at_rest;
    run.drift_m = std::max(run.drift_m, (update.state.T_w_b.p - before).norm());
  }
  return run;
}

TEST(Standstill, AStandingCameraDoesNotFollowAPersonWhoCoversMostOfTheImage) {
  const StandingRun with = run_standing({.enabled = true});
  EXPECT_EQ(with.false_rest, 0);
  EXPECT_GE(with.resting_frames, 140);  // of 150
  EXPECT_LE(with.drift_m, 0.02);
  const StandingRun without = run_standing({.enabled = false});
  EXPECT_EQ(without.resting_frames, 0);
  EXPECT_GT(without.drift_m, 2.0 * with.drift_m);
}

/// Two frames 0.3 s apart whose ten features have moved by `motion_px`, and resting samples.
struct RestingWindow {
  Window window;
  ImuBuffer imu;
  StandstillModel model{.noise = {.gyro_noise = 2e-4, .accel_noise = 2e-3, .gyro_walk = 0, .accel_walk = 0}};

  explicit RestingWindow(double motion_px) {
    window.inertial = true;
    for (const double t : {1.0, 1.3}) {
      window.frames.push_back({});
      window.frames.back().state.t = from_seconds(t);
    }
    for (int k = 0; k < 10; ++k) {
      Landmark landmark{.id = k};
      landmark.observations = {{}, {.bearing = {motion_px / model.focal_px, 0.0}}};
      window.landmarks.push_back(landmark);
    }
    for (int i = 0; i <= 100; ++i)
      imu.add({.t = from_seconds(0.5 + 0.01 * i), .gyro_b = {0, 0, 0}, .accel_b = {0, 0, 9.81}});
  }
  bool at_rest() { return is_at_rest(window, imu, {}, model); }
};

TEST(Standstill, RequiresThatInertialDataAndFeaturesAgree) {
  EXPECT_TRUE(RestingWindow(0.9).at_rest());
  EXPECT_FALSE(RestingWindow(1.1).at_rest());  // constant velocity is no rest
  RestingWindow fast(0.0);  // features far away, or on an object that moves with the camera
  fast.window.frames.back().state.v_w = {0.2, 0.0, 0.0};
  EXPECT_FALSE(fast.at_rest());
  RestingWindow turning(0.0);
  turning.window.frames.back().state.gyro_bias = {0.0, 0.0, 0.05};
  EXPECT_FALSE(turning.at_rest());
}

TEST(Standstill, RequiresTenStaticFeatures) {
  RestingWindow sparse(0.0);
  sparse.window.landmarks.pop_back();
  EXPECT_FALSE(sparse.at_rest());
}

}  // namespace
}  // namespace stillpoint
