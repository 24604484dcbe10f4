// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/calibration.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "tests/support/published_config.h"

namespace stillpoint {
namespace {

BackendConfig bounded_config() {
  BackendConfig config = published_config().backend;
  config.time_offset_bound_s = 0.1;
  config.extrinsics_bound_m = 0.05;
  config.extrinsics_bound_rad = 0.1;
  config.depth.scale_bound = 0.3;
  return config;
}

TEST(CalibrationBounds, LeaveAPlausibleCalibrationUnchanged) {
  Rig rig;
  rig.time_offset_s = 0.02;
  Window window;
  window.time_offset_s = 0.119;
  window.T_b_c = Pose{exp_so3({0.0, 0.09, 0.0}), {0.03, 0.03, 0.0}};
  window.depth_scale = 0.71;
  const Window before = window;
  const CalibrationAtBound at_bound = Calibration(bounded_config(), true, rig).limit(window);
  EXPECT_FALSE(at_bound.time_offset || at_bound.extrinsics || at_bound.depth_scale);
  EXPECT_EQ(window.time_offset_s, before.time_offset_s);
  EXPECT_EQ(window.T_b_c.p, before.T_b_c.p);
  EXPECT_EQ(window.T_b_c.q.coeffs(), before.T_b_c.q.coeffs());
  EXPECT_EQ(window.depth_scale, before.depth_scale);
}

TEST(CalibrationBounds, LimitTheDeviationFromTheRig) {
  Rig rig;
  rig.T_b_c = Pose{exp_so3({0.3, 0.0, 0.0}), {0.1, 0.0, 0.0}};
  rig.time_offset_s = 0.02;
  Window window;
  window.time_offset_s = -0.32;
  window.T_b_c = Pose{rig.T_b_c.q * exp_so3({0.0, 0.2, 0.0}), {0.1, 0.3, 0.4}};
  window.depth_scale = 1.5;
  const CalibrationAtBound at_bound = Calibration(bounded_config(), true, rig).limit(window);
  EXPECT_TRUE(at_bound.time_offset && at_bound.extrinsics && at_bound.depth_scale);
  EXPECT_DOUBLE_EQ(window.time_offset_s, -0.08);
  EXPECT_LT((window.T_b_c.p - Eigen::Vector3d(0.1, 0.03, 0.04)).norm(), 1e-12);  // 0.05 of (0.3, 0.4)
  EXPECT_NEAR(window.T_b_c.q.angularDistance(rig.T_b_c.q), 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(window.depth_scale, 1.3);
}

BackendConfig estimating_config() {
  BackendConfig config = published_config().backend;
  config.estimate_extrinsics = true;
  config.depth.estimate_scale = true;
  config.calibration_agreement_probability = 0.999;
  return config;
}

TEST(Calibration, IsThatOfTheRigUntilTheDataContradictsIt) {
  Rig rig;
  rig.T_b_c.p.x() = 0.1;
  rig.time_offset_s = 0.02;
  Calibration calibration(estimating_config(), true, rig);
  Window compared = calibration.calibrated_window();
  const AgreesWithRig& agrees = compared.agrees_with_rig;
  EXPECT_TRUE(agrees.extrinsics && agrees.depth_scale);
  StateCovariance covariance;
  covariance.extrinsics = 1e-6 * StateCovariance::Matrix6::Identity();
  RigStep step;
  // 16.8 is the 0.99 quantile of six degrees of freedom; a calibration leaves 0.003 rad.
  step.extrinsics[4] = 4.0 * std::sqrt(1e-6 + 0.003 * 0.003);
  calibration.compare_with_rig(step, covariance, compared);
  EXPECT_TRUE(agrees.extrinsics && agrees.depth_scale);
  step.extrinsics[4] *= 1.4;
  calibration.compare_with_rig(step, covariance, compared);
  EXPECT_FALSE(agrees.extrinsics);
  compared.T_b_c.p.x() = 0.12;
  calibration.compare_with_rig({}, covariance, compared);
  const Window window = calibration.calibrated_window();
  EXPECT_FALSE(window.agrees_with_rig.extrinsics);
  EXPECT_EQ(window.T_b_c.p.x(), 0.12);
  EXPECT_EQ(window.time_offset_s, rig.time_offset_s);
  EXPECT_EQ(window.depth_scale, 1.0);
}

/// One solve can move a scale by a tenth of its difference only.
TEST(Calibration, AScaleThatHasNotConvergedStillDiffersFromTheRig) {
  Calibration calibration(estimating_config(), true, {});
  Window window = calibration.calibrated_window();
  window.frames.emplace_back();
  StateCovariance covariance;
  covariance.depth_scale = 1e-4;
  const auto compare_at = [&](double seconds, double step) {
    window.frames.back().state.t = after({}, seconds);
    calibration.compare_with_rig({.depth_scale = step}, covariance, window);
  };
  compare_at(0.0, 0.0);
  compare_at(5.0, 0.1);
  EXPECT_FALSE(window.agrees_with_rig.depth_scale);
  window.depth_scale = 0.99;
  compare_at(5.03, 0.09);
  EXPECT_FALSE(window.agrees_with_rig.depth_scale);
  EXPECT_EQ(window.depth_scale, 0.99);
  compare_at(5.07, 0.0);
  EXPECT_TRUE(window.agrees_with_rig.depth_scale);
}

TEST(Calibration, TheLensIsThatOfTheRigWithinWhatACalibrationIsGoodTo) {
  BackendConfig config = estimating_config();
  config.estimate_lens = true;
  Calibration calibration(config, true, {});
  Window window = calibration.calibrated_window();
  StateCovariance covariance;
  covariance.lens = 1e-6 * Eigen::Matrix4d::Identity();
  EXPECT_TRUE(window.agrees_with_rig.lens);
  calibration.compare_with_rig({.lens = {0.0015, 0.002, 0.0, 0.0}}, covariance, window);
  EXPECT_TRUE(window.agrees_with_rig.lens);
  calibration.compare_with_rig({.lens = {0.02, 0.0, 0.0, 0.0}}, covariance, window);
  EXPECT_FALSE(window.agrees_with_rig.lens);
  window.lens = {0.02, -0.04, 0.0, 0.01};
  calibration.compare_with_rig({}, covariance, window);
  EXPECT_EQ(calibration.calibrated_window().lens, Eigen::Vector4d(0.02, -0.04, 0.0, 0.01));
  const Eigen::Matrix4d root = calibration.prior().jacobian.bottomRightCorner<4, 4>();
  EXPECT_TRUE((root.transpose() * root).isApprox(1e6 * Eigen::Matrix4d::Identity()));
  window.lens = {0.001, 0.001, 0.0, 0.0};
  calibration.compare_with_rig({}, covariance, window);
  EXPECT_TRUE(window.agrees_with_rig.lens);
  EXPECT_EQ(window.lens, Eigen::Vector4d::Zero());
  EXPECT_EQ(calibration.calibrated_window().lens, Eigen::Vector4d::Zero());
}

/// OpenLORIS home1-3 with fault rig:seed=34, whose rotations had a NEES / 3 of 43.
TEST(Calibration, ASmallDistortionThatIsWellKnownContradictsTheRig) {
  BackendConfig config = estimating_config();
  config.estimate_lens = true;
  Calibration calibration(config, true, {});
  Window window = calibration.calibrated_window();
  StateCovariance covariance;
  covariance.lens = Eigen::Vector4d(0.0005, 0.0004, 0.0003, 0.0003).cwiseAbs2().asDiagonal();
  calibration.compare_with_rig({.lens = {-0.001, 0.009, 0.0005, 0.0}}, covariance, window);
  EXPECT_FALSE(window.agrees_with_rig.lens);
}

/// A calibration and a window that are compared after `seconds` for the second time.
struct Compared {
  Calibration calibration{estimating_config(), true, {}};
  Window window = calibration.calibrated_window();

  void compare(double step, double sigma, double seconds) {
    window.frames.resize(1);
    window.frames.back().state.t = after(Timestamp{}, seconds);
    StateCovariance covariance;
    covariance.depth_scale = sigma * sigma;
    calibration.compare_with_rig({.depth_scale = step}, covariance, window);
  }
};

TEST(Calibration, StartsWithTheDepthScaleThatWasFound) {
  Compared compared;
  compared.compare(0.0, 0.1, 0.0);
  compared.compare(0.1, 0.01, 5.0);
  ASSERT_FALSE(compared.window.agrees_with_rig.depth_scale);
  compared.window.depth_scale = 0.9;
  compared.compare(0.0, 0.01, 5.1);
  const Window window = compared.calibration.calibrated_window();
  EXPECT_DOUBLE_EQ(window.depth_scale, 0.9);
  EXPECT_FALSE(window.agrees_with_rig.depth_scale);
}

TEST(Calibration, DoubtsTheDepthScaleOfTheFirstSecond) {
  Compared early, late;
  early.compare(0.0, 0.1, 0.0);
  late.compare(0.0, 0.1, 0.0);
  early.compare(0.05, 0.01, 0.5);
  late.compare(0.05, 0.01, 5.0);
  EXPECT_TRUE(early.window.agrees_with_rig.depth_scale);
  EXPECT_FALSE(late.window.agrees_with_rig.depth_scale);
}

TEST(Calibration, ADepthScaleWithinTheErrorOfAnAccelerometerIsThatOfTheRig) {
  Compared compared;
  compared.compare(0.0, 0.1, 0.0);
  compared.compare(0.015, 0.001, 20.0);
  EXPECT_TRUE(compared.window.agrees_with_rig.depth_scale);
}

TEST(Calibration, ADepthScaleIsAnotherOneFromTheNinetyNinePercentQuantileOn) {
  for (const bool other : {false, true}) {
    Compared compared;
    compared.compare(0.0, 0.01, 0.0);
    // Variances: 0.01^2 (1 + (1.5 / 15)^2) + 0.006^2 = 0.0117^2. Quantile: 2.58^2.
    compared.compare(other ? 0.0308 : 0.0296, 0.01, 15.0);
    EXPECT_EQ(compared.window.agrees_with_rig.depth_scale, !other);
  }
}

TEST(Calibration, ADepthScaleThatComesCloseToTheRigIsThatOfTheRigAgain) {
  Compared compared;
  compared.compare(0.0, 0.1, 0.0);
  compared.compare(0.1, 0.01, 5.0);
  ASSERT_FALSE(compared.window.agrees_with_rig.depth_scale);
  compared.window.depth_scale = 0.99;
  compared.compare(0.0, 0.006, 8.0);
  EXPECT_TRUE(compared.window.agrees_with_rig.depth_scale);
  EXPECT_EQ(compared.window.depth_scale, 1.0);
}

/// 3 s of a clipped accelerometer on a robot: a difference of 2.8 standard deviations of 0.069, by a prior of
/// 0.1 (accel_saturated:amount=12 on market, 0.44 m).
TEST(Calibration, ADepthScaleThatInertialDataHardlyObservesIsThatOfTheRig) {
  for (const double sigma : {0.049, 0.051}) {
    Compared compared;
    compared.compare(0.0, 0.1, 0.0);
    compared.compare(0.2, sigma, 20.0);
    EXPECT_EQ(compared.window.agrees_with_rig.depth_scale, sigma > 0.05);
  }
}

TEST(Calibration, DoubtsTheDepthScaleOfTheFirstSecondAfterARestart) {
  Compared compared;
  compared.compare(0.0, 0.1, 0.0);
  compared.calibration.window_restarted();
  compared.compare(0.1, 0.01, 20.0);
  EXPECT_TRUE(compared.window.agrees_with_rig.depth_scale);
  compared.compare(0.1, 0.01, 25.0);
  EXPECT_FALSE(compared.window.agrees_with_rig.depth_scale);
}

/// The scale of a camera is a constant (imu_rate:amount=30 on V1_03 after a restart: 0.36 m).
TEST(Calibration, AWindowStartsWithTheDepthScaleAsItWasConfirmedBefore) {
  Compared compared;
  compared.compare(0.0, 0.1, 0.0);
  compared.compare(0.005, 0.01, 5.0);
  const auto prior_information = [&] { return compared.calibration.prior().jacobian.squaredNorm(); };
  const double before = prior_information();
  compared.calibration.window_restarted();
  // A calibration leaves 0.006.
  EXPECT_NEAR(prior_information() - before, 1.0 / (0.01 * 0.01 + 0.006 * 0.006) - 1.0 / (0.1 * 0.1), 1e-3);
  compared.compare(0.3, 0.03, 10.0);
  compared.compare(0.3, 0.03, 20.0);
  EXPECT_TRUE(compared.window.agrees_with_rig.depth_scale);
}

TEST(Calibration, ADepthScaleThatWasFoundIsKeptThoughThatOfTheRigWasConfirmedBefore) {
  Compared compared;
  compared.compare(0.0, 0.1, 0.0);
  compared.compare(0.02, 0.03, 5.0);
  compared.compare(0.06, 0.02, 15.0);
  ASSERT_FALSE(compared.window.agrees_with_rig.depth_scale);
  compared.calibration.window_restarted();
  compared.compare(0.06, 0.02, 15.1);
  EXPECT_FALSE(compared.window.agrees_with_rig.depth_scale);
}

TEST(Calibration, StartsWithAnAlignmentThatContradictsTheRig) {
  BackendConfig config = estimating_config();
  config.initializer.align_rotations = true;
  Calibration calibration(config, true, {});
  ASSERT_TRUE(calibration.awaits_alignment());
  RotationAlignment alignment{.q_b_c = exp_so3({0.0, 0.1, 0.0}), .time_offset_s = 0.03};
  alignment.covariance = 1e-6 * Eigen::Matrix4d::Identity();
  alignment.rig_contradiction = 100.0;
  EXPECT_TRUE(calibration.align(alignment));
  EXPECT_FALSE(calibration.awaits_alignment());
  EXPECT_EQ(calibration.calibrated_window().time_offset_s, 0.03);
  EXPECT_EQ(calibration.calibrated_window().T_b_c.q.coeffs(), alignment.q_b_c.coeffs());
  alignment.rig_contradiction = 1.0;
  EXPECT_FALSE(calibration.align(alignment));
  EXPECT_EQ(calibration.calibrated_window().time_offset_s, 0.0);
}

/// A time offset that is certain before the rotation: the extrinsics stay those of the rig, and are still
/// awaited.
TEST(Calibration, StartsWithATimeOffsetAloneThatContradictsTheRig) {
  BackendConfig config = estimating_config();
  config.initializer.align_rotations = true;
  Calibration calibration(config, true, {});
  RotationAlignment alignment{.time_offset_s = 0.05, .rig_contradiction = 1.0, .is_of_offset_alone = true};
  EXPECT_FALSE(calibration.align(alignment));
  EXPECT_EQ(calibration.calibrated_window().time_offset_s, 0.0);
  alignment.rig_contradiction = 100.0;
  EXPECT_TRUE(calibration.align(alignment));
  EXPECT_EQ(calibration.calibrated_window().time_offset_s, 0.05);
  EXPECT_FALSE(calibration.calibrated_window().is_realigned);
  EXPECT_TRUE(calibration.awaits_alignment());
  EXPECT_FALSE(calibration.aligned_rotation());
}

/// Constant extrinsics become variable if rotations contradict those of the rig. What the residuals said
/// about the lens until then was said with the wrong rotation.
TEST(Calibration, EstimatesExtrinsicsSinceRotationsContradictThem) {
  BackendConfig config = estimating_config();
  config.estimate_extrinsics = false;
  config.estimate_lens = true;
  config.initializer.align_rotations = true;
  Calibration calibration(config, true, {});
  EXPECT_FALSE(calibration.calibrated_window().is_realigned);
  RotationAlignment alignment{.q_b_c = exp_so3({0.0, 0.1, 0.0})};
  alignment.covariance = 1e-6 * Eigen::Matrix4d::Identity();
  alignment.rig_contradiction = 1.0;
  alignment.rotation_deviations = 0.5;
  EXPECT_FALSE(calibration.align(alignment));
  EXPECT_FALSE(calibration.calibrated_window().is_realigned);
  EXPECT_EQ(calibration.aligned_rotation()->deviations, 0.5);
  StateCovariance covariance;
  covariance.lens = 1e-8 * Eigen::Matrix4d::Identity();
  Window window = calibration.calibrated_window();
  window.frames.emplace_back();
  calibration.compare_with_rig({.lens = {0.0, 0.0, 0.05, 0.0}}, covariance, window);
  ASSERT_FALSE(calibration.calibrated_window().agrees_with_rig.lens);
  alignment.rig_contradiction = 100.0;
  EXPECT_FALSE(calibration.align(alignment));
  alignment.is_certain = true;
  EXPECT_TRUE(calibration.align(alignment));
  EXPECT_TRUE(calibration.calibrated_window().is_realigned);
  EXPECT_TRUE(calibration.calibrated_window().agrees_with_rig.lens);
  EXPECT_NEAR(calibration.aligned_rotation()->difference_rad, 0.1, 1e-9);
}

}  // namespace
}  // namespace stillpoint
