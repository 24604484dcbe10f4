// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/imu_rate_poses.h"

#include <gtest/gtest.h>

#include "core/pipeline/runners/runner.h"
#include "tests/support/simulated/inertial_plane.h"

namespace stillpoint {
namespace {

constexpr double kInterval_s = 0.005;

/// Samples of a body at constant velocity, with gravity along -z, every 5 ms from 0 to 1 s.
std::vector<ImuSample> level_samples() {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 200; ++i) {
    samples.push_back(
        {.t = from_seconds(i * kInterval_s), .gyro_b = Eigen::Vector3d::Zero(), .accel_b = {0.0, 0.0, 9.81}});
  }
  return samples;
}

/// Estimate at time `t`: 1 m/s along x from the origin, `error_m` further along y.
OdometryUpdate update_at(double t, double error_m = 0.0) {
  OdometryUpdate update;
  update.status = OdometryStatus::kTracking;
  update.inertial = true;
  update.state.t = from_seconds(t);
  update.state.T_w_b.p = {t, error_m, 0.0};
  update.state.v_w = {1.0, 0.0, 0.0};
  update.T_w_c = update.state.T_w_b;
  return update;
}

TEST(ImuRatePoses, PropagateTheNewestEstimateThatIsAvailableAtEachSample) {
  const std::vector<ImuSample> samples = level_samples();
  ImuRatePoses poses({}, samples);
  poses.add(update_at(0.1), from_seconds(0.12));
  poses.add(update_at(0.2, 0.03), from_seconds(0.22));
  poses.add(update_at(0.3), from_seconds(0.32));
  const ImuRateOutput output = poses.take();
  // Samples from 0.12 s, when the first estimate is available, to the last one before 0.32 s.
  ASSERT_EQ(output.trajectory.poses.size(), 40u);
  EXPECT_EQ(output.trajectory.poses.front().t, from_seconds(0.12));
  for (const StampedPose& pose : output.trajectory.poses) {
    const double t = to_seconds(pose.t);
    EXPECT_NEAR(pose.T_w_f.p.x(), t, 1e-12);
    EXPECT_NEAR(pose.T_w_f.p.y(), t < 0.22 - 1e-9 ? 0.0 : 0.03, 1e-12) << t;
  }
  EXPECT_NEAR(output.ages_ms.front(), 20.0, 1e-9);
  EXPECT_NEAR(output.ages_ms[19], 115.0, 1e-9);  // at 0.215 s, by the estimate at 0.1 s
}

TEST(ImuRatePoses, ContinueAtTheLastVelocityWhileInertialDataIsNotUsed) {
  const std::vector<ImuSample> samples = level_samples();
  ImuRatePoses poses({}, samples);
  for (const double t : {0.1, 0.2, 0.3}) {
    OdometryUpdate update = update_at(t);
    update.inertial = false;
    update.state.v_w.setZero();
    poses.add(update, from_seconds(t + 0.02));
  }
  const ImuRateOutput output = poses.take();
  ASSERT_EQ(output.trajectory.poses.size(), 40u);
  EXPECT_NEAR(output.trajectory.poses[19].T_w_f.p.x(), 0.1, 1e-12);  // of one estimate: no velocity yet
  EXPECT_NEAR(output.trajectory.poses[39].T_w_f.p.x(), 0.315, 1e-12);
}

/// The step between worlds, or to a place in the map, is no velocity.
TEST(ImuRatePoses, DoNotContinueAJump) {
  const std::vector<ImuSample> samples = level_samples();
  ImuRatePoses poses({}, samples);
  poses.add(update_at(0.1), from_seconds(0.12));
  OdometryUpdate jumped = update_at(0.2, 3.0);
  jumped.inertial = false;
  jumped.status = OdometryStatus::kRelocated;
  poses.add(jumped, from_seconds(0.22));
  poses.add(update_at(0.3), from_seconds(0.32));
  EXPECT_NEAR(poses.take().trajectory.poses.back().T_w_f.p.y(), 3.0, 1e-12);
}

TEST(ImuRatePoses, RecordTheStepThatEachEstimateCauses) {
  const std::vector<ImuSample> samples = level_samples();
  ImuRatePoses poses({}, samples);
  poses.add(update_at(0.1), from_seconds(0.12));
  poses.add(update_at(0.2, 0.03), from_seconds(0.22));
  const ImuRateOutput output = poses.take();
  ASSERT_EQ(output.corrections.size(), 1u);  // nothing precedes the first estimate
  EXPECT_NEAR(output.corrections[0].translation_m, 0.03, 1e-12);
  EXPECT_NEAR(output.corrections[0].rotation_deg, 0.0, 1e-6);
}

TEST(ImuRatePoses, HaveStampsOnTheClockOfTheFrames) {
  const std::vector<ImuSample> samples = level_samples();
  ImuRatePoses poses({}, samples);
  OdometryUpdate update = update_at(0.1);
  update.time_offset_s = 0.015;  // exposed at 0.115 s on the IMU clock
  poses.add(update, from_seconds(0.14));
  poses.add(update, from_seconds(0.145));
  const ImuRateOutput output = poses.take();
  ASSERT_EQ(output.trajectory.poses.size(), 1u);
  EXPECT_EQ(output.trajectory.poses[0].t, from_seconds(0.125));
  EXPECT_NEAR(output.trajectory.poses[0].T_w_f.p.x(), 0.125, 1e-12);
}

TEST(ImuRatePoses, AreAbsentWhileTrackingIsLost) {
  const std::vector<ImuSample> samples = level_samples();
  ImuRatePoses poses({}, samples);
  poses.add(update_at(0.1), from_seconds(0.12));
  OdometryUpdate lost = update_at(0.2);
  lost.status = OdometryStatus::kLost;
  poses.add(lost, from_seconds(0.22));
  poses.add(update_at(0.3, 0.1), from_seconds(0.32));
  poses.add(update_at(0.4), from_seconds(0.42));
  const ImuRateOutput output = poses.take();
  ASSERT_EQ(output.trajectory.poses.size(), 40u);
  EXPECT_EQ(output.trajectory.poses[19].t, from_seconds(0.215));
  EXPECT_EQ(output.trajectory.poses[20].t, from_seconds(0.32));
  EXPECT_EQ(output.corrections.size(), 1u);  // only between two estimates of one track
}

ImuRateOutput output_of(const decltype(run_sequential)& runner) {
  const SlidingPlane plane(40);
  const std::vector<ImuSample> samples = plane_imu(2.0);
  SensorInput input = plane.input();
  input.rig = inertial_plane_rig(plane);
  input.imu = samples;
  const OdometryConfig config = inertial_config(1);
  ImuRatePoses poses(config, samples);
  const RunControl control{
      .on_frame = {[&](const FrameReport& report) { poses.add(report.update, report.available); }}};
  static_cast<void>(runner(input, config, control));
  return poses.take();
}

TEST(ImuRatePoses, ArePipelinedBitEqualToSequential) {
  const ImuRateOutput sequential = output_of(run_sequential);
  const ImuRateOutput pipelined = output_of(run_pipelined);
  ASSERT_GT(sequential.trajectory.poses.size(), 150u);  // about 1 s at 200 Hz
  ASSERT_EQ(sequential.trajectory.poses.size(), pipelined.trajectory.poses.size());
  for (std::size_t i = 0; i < sequential.trajectory.poses.size(); ++i) {
    const StampedPose& a = sequential.trajectory.poses[i];
    const StampedPose& b = pipelined.trajectory.poses[i];
    EXPECT_EQ(a.t, b.t);
    EXPECT_EQ(a.T_w_f.p, b.T_w_f.p);
    EXPECT_EQ(a.T_w_f.q.coeffs(), b.T_w_f.q.coeffs());
  }
  EXPECT_EQ(sequential.corrections.size(), pipelined.corrections.size());
}

}  // namespace
}  // namespace stillpoint
