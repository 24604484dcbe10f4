// SPDX-License-Identifier: BSD-3-Clause
// Wrong inertial data and wrong vision in the optimization stage, whose consistency check before the solve
// depends on the inertial prediction. Simulated motion; undisturbed, the largest error is 0.01 m.
#include <gtest/gtest.h>

#include "core/pipeline/stages/optimization_stage.h"
#include "tests/support/simulated/faulty_run.h"

namespace stillpoint {
namespace {

using enum OdometryStatus;

/// The default, but for the backend.
OdometryConfig stage_config(const FaultyScenario& scenario) {
  OdometryConfig config;
  config.backend = scenario.backend;
  config.imu = imu_config_of(scenario);
  return config;
}

FaultyRun run_stage(const FaultyScenario& scenario) {
  OptimizationStage stage(stage_config(scenario), rig_of(scenario));
  return run_with_faults(scenario, stage, [&](const TrackedFrame& frame) -> const OdometryUpdate& {
    return stage.process(frame, {});
  });
}

/// From `begin` on, a person without a box covers most of the image: eight of ten features are replaced by
/// ones at a depth of 0.6 m that move with the person.
std::function<void(TrackedFrame&)> person_in_front(double begin) {
  return [=](TrackedFrame& frame) {
    const double t = to_seconds(frame.t) - begin;
    if (t < 0.0) return;
    const Camera camera = SimulatedMotion::rig().camera;
    for (TrackedFeature& feature : frame.features) {
      if (feature.id % 10 >= 8) continue;
      const double row = static_cast<double>(feature.id % 17) / 17.0 - 0.5;
      const double column = static_cast<double>(feature.id % 13) / 13.0 - 0.5;
      feature.depth = 0.6;
      feature.bearing = {column + 0.25 * std::sin(2.0 * t), 0.8 * row + 0.05 * std::sin(5.0 * t)};
      feature.pixel = camera.project(feature.bearing.homogeneous());
      feature.id += 100000;
    }
    std::ranges::sort(frame.features, {}, &TrackedFeature::id);
  };
}

TEST(OptimizationFaults, AnUndisturbedRunIsTracking) {
  const FaultyRun run = run_stage({});
  EXPECT_EQ(run.count(0.5, kEnd_s, kTracking), run.count(0.5, kEnd_s, [](const auto&) { return true; }));
  EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.015);
}

TEST(OptimizationFaults, TheCheckBeforeTheSolveDoesNotHideAShock) {
  for (const Eigen::Vector3d& force :
       {Eigen::Vector3d(8.0, 0.0, 0.0), Eigen::Vector3d(0.0, 15.0, 12.0), Eigen::Vector3d(0.0, -5.0, 6.0)}) {
    FaultyScenario scenario;
    scenario.change_imu = shock(kBegin_s, kBegin_s + 1.0, force);
    const FaultyRun run = run_stage(scenario);
    EXPECT_EQ(run.count_located(0.5, kEnd_s), run.count(0.5, kEnd_s, [](const auto&) { return true; }));
    EXPECT_EQ(run.count(7.0, kEnd_s, kTracking), run.count(7.0, kEnd_s, [](const auto&) { return true; }));
    EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.03) << force.transpose();
  }
}

TEST(OptimizationFaults, APersonWhoFillsTheImageDoesNotContradictASoundImu) {
  FaultyScenario scenario;
  scenario.change_frame = person_in_front(kBegin_s);
  const FaultyRun run = run_stage(scenario);
  EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.05);
  EXPECT_EQ(run.count(0.0, kEnd_s,
                      [](const FaultyFrame& frame) {
                        return frame.update.reason == StatusReason::kImuInconsistent;
                      }),
            0);
}

/// Fewer than the 40 features of certain vision. A step makes them appear to move, and the check before the
/// solve labels them.
TEST(OptimizationFaults, AStepOfTheAccelerometerIsFollowedByFewFeatures) {
  for (const double step : {0.3, 1.0}) {
    FaultyScenario scenario;
    scenario.change_frame = [](TrackedFrame& frame) {
      std::erase_if(frame.features, [](const TrackedFeature& feature) { return feature.id % 3 != 0; });
    };
    scenario.change_imu = [&](std::vector<ImuSample>& samples) {
      for (ImuSample& sample : samples) {
        if (to_seconds(sample.t) >= kBegin_s) sample.accel_b.array() += step;
      }
    };
    scenario.backend.bias_steps = true;
    const FaultyRun run = run_stage(scenario);
    const Eigen::Vector3d bias = run.frames.back().update.state.accel_bias;
    EXPECT_LT((bias - Eigen::Vector3d::Constant(0.05 + step)).norm(), 0.1) << step;
    EXPECT_LT(run.worst_error_m(0.0, kEnd_s), 0.1) << step;
  }
}

/// The gyroscope of a sound IMU errs by little, and its data often changes by chance in that direction.
TEST(InertialErrors, AreExplainedByTheirOwnSensor) {
  InertialError error{.accel_w = {10.0, 0.0, 0.0},
                      .gyro_b = {0.001, 0.0, 0.0},
                      .accel_change_w = {0.0, 3.0, 0.0},
                      .gyro_change_b = {0.01, 0.0, 0.0}};
  EXPECT_FALSE(error.accel_is_explained());
  EXPECT_TRUE(error.gyro_is_explained());
  error.accel_change_w = {9.0, 1.0, 0.0};
  EXPECT_TRUE(error.accel_is_explained());
}

}  // namespace
}  // namespace stillpoint
