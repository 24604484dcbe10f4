// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/estimator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/pipeline/imu_queue.h"
#include "tests/support/published_config.h"
#include "tests/support/simulated/simulated_motion.h"

namespace stillpoint {
namespace {

constexpr double kRate_hz = 30.0;

struct SimulatedRun {
  double position_rmse_m = 0.0;    ///< relative to the first reported pose, no alignment
  double rotation_rmse_rad = 0.0;  ///< of the motion over 1 s
  double first_pose_s = -1.0;
  double time_offset_s = 0.0;
  int poses = 0;
  NavState last;
};

/// Root mean square of the change of a rotation error over 1 s [rad].
double change_over_one_second(const std::vector<Eigen::Quaterniond>& errors) {
  const auto step = static_cast<std::size_t>(kRate_hz);
  double squared = 0.0;
  for (std::size_t i = step; i < errors.size(); ++i) {
    squared += std::pow(errors[i].angularDistance(errors[i - step]), 2);
  }
  return std::sqrt(squared / static_cast<double>(errors.size() - step));
}

/// Evaluates poses relative to the first reported one against ground truth relative to the same time.
SimulatedRun simulate(const SimulatedMotion& motion, const BackendConfig& backend,
                      const ImuConfig& imu_config, double seconds) {
  Rig rig = SimulatedMotion::rig();
  rig.imu_noise = motion.imu_noise;
  Estimator estimator(backend, imu_config, rig, 1);
  const std::vector<ImuSample> imu = motion.imu(seconds + 0.5);
  std::size_t next = 0;
  SimulatedRun run;
  std::optional<Pose> T_first, T_first_true;
  double squared = 0.0;
  std::vector<Eigen::Quaterniond> rotation_errors;
  for (int i = 0; i < static_cast<int>(seconds * kRate_hz); ++i) {
    const double t = 0.1 + i / kRate_hz;
    for (; next < imu.size() && to_seconds(imu[next].t) < t + 0.05; ++next) estimator.add_imu(imu[next]);
    const OdometryUpdate& update = estimator.process(motion.frame(i, t));
    if (!is_located(update.status)) continue;
    const Pose truth = SimulatedMotion::state(t + motion.time_offset_s).T_w_b;
    if (!T_first) {
      T_first = update.state.T_w_b;
      T_first_true = truth;
      run.first_pose_s = t - 0.1;
    }
    const Pose moved = T_first->inverse() * update.state.T_w_b;
    const Pose moved_true = T_first_true->inverse() * truth;
    squared += (moved.p - moved_true.p).squaredNorm();
    rotation_errors.push_back(moved.q * moved_true.q.conjugate());
    ++run.poses;
    run.last = update.state;
    run.time_offset_s = update.time_offset_s;
  }
  run.position_rmse_m = std::sqrt(squared / run.poses);
  run.rotation_rmse_rad = change_over_one_second(rotation_errors);
  return run;
}

BackendConfig every_frame() {
  BackendConfig config = published_config().backend;
  config.rate_hz = 0.0;
  config.depth.usage = DepthUsage::kWeighted;
  config.initializer.kind = InitializerKind::kInstant;
  return config;
}

TEST(Estimator, TracksANoiseFreeTrajectory) {
  const SimulatedRun run = simulate(SimulatedMotion{}, every_frame(), {}, 5.0);
  EXPECT_LT(run.first_pose_s, 0.4);
  EXPECT_LT(run.position_rmse_m, 0.002);
}

TEST(Estimator, TracksANoisyTrajectoryAndEstimatesItsBiases) {
  const SimulatedMotion motion{.pixel_noise_px = 0.5, .depth_noise = 0.003, .noisy_imu = true};
  const SimulatedRun run = simulate(motion, every_frame(), {}, 10.0);
  EXPECT_LT(run.position_rmse_m, 0.03);
  EXPECT_LT((run.last.gyro_bias - Eigen::Vector3d::Constant(0.02)).norm(), 0.005);
}

TEST(Estimator, AWorldWithEstimatedGravityDoesNotTurn) {
  const SimulatedMotion motion{.pixel_noise_px = 0.5, .depth_noise = 0.003, .noisy_imu = true};
  BackendConfig config = every_frame();
  config.solver = WindowSolverKind::kSchur;
  const SimulatedRun fixed = simulate(motion, config, {}, 6.0);
  config.gravity = GravityModel::kEstimated;
  const SimulatedRun estimated = simulate(motion, config, {}, 6.0);
  // With constant gravity the poses turn while the accelerometer bias becomes known.
  EXPECT_LT(estimated.rotation_rmse_rad, 0.5 * fixed.rotation_rmse_rad);
  EXPECT_LT(estimated.rotation_rmse_rad, 0.002);
  EXPECT_LT(estimated.position_rmse_m, 0.03);
}

TEST(Estimator, ARestartKeepsGravityWithItsCovariance) {
  const SimulatedMotion motion{.pixel_noise_px = 0.3, .depth_noise = 0.003, .noisy_imu = true};
  BackendConfig config = every_frame();
  config.solver = WindowSolverKind::kSchur;
  config.gravity = GravityModel::kEstimated;
  Estimator estimator(config, {}, SimulatedMotion::rig(), 1);
  std::vector<ImuSample> imu = motion.imu(8.0);
  imu[700].accel_b.x() = 1e300;  // at 3.5 s
  for (const ImuSample& sample : imu) estimator.add_imu(sample);
  Eigen::Vector3d before = Eigen::Vector3d::Zero(), after = before;
  bool reset = false, known = false;
  for (int i = 0; i < 150; ++i) {
    const OdometryUpdate& update = estimator.process(motion.frame(i, 0.1 + i / kRate_hz));
    if (update.counters.reset) known = estimator.window().gravity_covariance.has_value();
    reset |= update.counters.reset;
    (reset ? after : before) = estimator.window().gravity_w;
  }
  ASSERT_TRUE(reset && known);
  EXPECT_TRUE(estimator.window().inertial);
  EXPECT_LT((after - before).norm(), 0.15);
  ASSERT_TRUE(estimator.window().gravity_covariance);
  EXPECT_LT(estimator.window().gravity_covariance->trace(), 4e-4);  // 0.02 after an alignment
}

TEST(Estimator, TracksWithoutAnImu) {
  const SimulatedMotion motion{.pixel_noise_px = 0.3, .depth_noise = 0.003};
  ImuConfig no_imu;
  no_imu.enabled = false;
  const SimulatedRun run = simulate(motion, every_frame(), no_imu, 5.0);
  EXPECT_EQ(run.first_pose_s, 0.0);
  EXPECT_LT(run.position_rmse_m, 0.03);
}

TEST(Estimator, TracksWithConstantDepthsAtTheBackendRateOfThePaper) {
  BackendConfig config = published_config().backend;
  const SimulatedRun run =
      simulate(SimulatedMotion{.pixel_noise_px = 0.3, .depth_noise = 0.001}, config, {}, 5.0);
  EXPECT_LT(run.position_rmse_m, 0.03);
}

TEST(Estimator, EstimatesTheTimeOffset) {
  BackendConfig config = every_frame();
  config.time_offset_sigma_s = 0.05;
  const SimulatedRun run =
      simulate(SimulatedMotion{.pixel_noise_px = 0.2, .time_offset_s = 0.008}, config, {}, 8.0);
  // The published prior does not contain the offset, which therefore stays nearer to the calibrated value 0.
  EXPECT_NEAR(run.time_offset_s, 0.008, 0.0025);
  config.time_offset_model = TimeOffsetModel::kInertial;
  config.gravity = GravityModel::kEstimated;
  config.prior = PriorModel::kConsistent;
  const SimulatedRun inertial =
      simulate(SimulatedMotion{.pixel_noise_px = 0.2, .time_offset_s = 0.008}, config, {}, 8.0);
  EXPECT_NEAR(inertial.time_offset_s, 0.008, 0.001);
}

TEST(Estimator, LosesNoPoseAtALargeTimeOffsetWithTheSamplesThatRunnersProvide) {
  const SimulatedMotion motion{.time_offset_s = 0.1};
  BackendConfig config = every_frame();
  config.time_offset_sigma_s = 0.1;
  Estimator estimator(config, {}, SimulatedMotion::rig(), 1);
  const std::vector<ImuSample> imu = motion.imu(12.0);
  std::size_t next = 0;
  int poses = 0;
  int lost = 0;
  for (int i = 0; i < 300; ++i) {
    const double t = 0.1 + i / kRate_hz;
    const Timestamp end = imu_end_of(from_seconds(t), estimator.motion_state().time_offset_s);
    for (; imu[next].t <= end; ++next) estimator.add_imu(imu[next]);
    const OdometryUpdate& update = estimator.process(motion.frame(i, t));
    poses += is_located(update.status);
    lost += update.status == OdometryStatus::kLost;
  }
  EXPECT_EQ(lost, 0);
  EXPECT_GT(poses, 280);
}

TEST(Estimator, IsDeterministic) {
  const SimulatedMotion motion{.pixel_noise_px = 0.5, .depth_noise = 0.003, .noisy_imu = true};
  const SimulatedRun first = simulate(motion, every_frame(), {}, 2.0);
  const SimulatedRun second = simulate(motion, every_frame(), {}, 2.0);
  EXPECT_EQ(first.last.T_w_b.p, second.last.T_w_b.p);
  EXPECT_EQ(first.last.T_w_b.q.coeffs(), second.last.T_w_b.q.coeffs());
}

BackendConfig monocular() {
  BackendConfig config = every_frame();
  config.rate_hz = 10.0;
  config.depth.usage = DepthUsage::kOff;
  config.initializer.kind = InitializerKind::kMonocular;
  return config;
}

TEST(Estimator, TracksWithoutDepthAndEstimatesTheScale) {
  const SimulatedMotion motion{.pixel_noise_px = 0.3};
  const SimulatedRun run = simulate(motion, monocular(), {}, 8.0);
  EXPECT_LT(run.first_pose_s, 2.0);
  // The trajectory spans 0.8 m; same limit as with noisy depth.
  EXPECT_LT(run.position_rmse_m, 0.03);
}

TEST(Estimator, IgnoresDepthWhenItIsOff) {
  // Depths that are wrong by a factor of two must not change the result in any bit.
  const SimulatedRun right = simulate({.pixel_noise_px = 0.3}, monocular(), {}, 3.0);
  const SimulatedRun wrong =
      simulate({.pixel_noise_px = 0.3, .depth_noise = 0.0, .depth_factor = 2.0}, monocular(), {}, 3.0);
  EXPECT_EQ(right.last.T_w_b.p, wrong.last.T_w_b.p);
  EXPECT_GT(right.poses, 0);
}

TEST(Estimator, RejectsConfigurationsWithoutAScaleSource) {
  BackendConfig no_depth = every_frame();
  no_depth.depth.usage = DepthUsage::kOff;
  EXPECT_THROW(Estimator(no_depth, {}, SimulatedMotion::rig(), 1), InputError);
  ImuConfig no_imu;
  no_imu.enabled = false;
  EXPECT_THROW(Estimator(monocular(), no_imu, SimulatedMotion::rig(), 1), InputError);
}

TEST(Estimator, RejectsMonocularInitializationWithDepth) {
  BackendConfig config = monocular();
  config.depth.usage = DepthUsage::kWeighted;
  EXPECT_THROW(Estimator(config, {}, SimulatedMotion::rig(), 1), InputError);
}

TEST(Estimator, RejectsAComparisonWithTheRigWithoutACovariance) {
  BackendConfig config = every_frame();
  config.estimate_extrinsics = true;
  config.calibration_agreement_probability = 0.9999;
  config.covariance = false;
  EXPECT_THROW(Estimator(config, {}, SimulatedMotion::rig(), 1), InputError);
}

TEST(Estimator, RejectsARigWithoutTheRequiredImu) {
  Rig rig = SimulatedMotion::rig();
  rig.has_imu = false;
  EXPECT_THROW(Estimator(every_frame(), {}, rig, 1), InputError);
}

}  // namespace
}  // namespace stillpoint
