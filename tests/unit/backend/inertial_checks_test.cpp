// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/inertial_checks.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/geometry/covariance.h"
#include "core/geometry/so3.h"
#include "core/imu/propagation.h"

namespace stillpoint {
namespace {

const Eigen::Vector3d kGravity_w(0.0, 0.0, -9.81);
constexpr double kRate_hz = 200.0;
constexpr double kFrame_s = 0.04;

Timestamp at(double seconds) { return after({}, seconds); }

/// Samples of a level body that accelerates along x, and turns about z, from `begin_s` on.
ImuBuffer samples_of(double accel, double begin_s, double rate = 0.0) {
  ImuBuffer imu(0.05);
  for (int i = 0; i <= 2.0 * kRate_hz; ++i) {
    const double t = i / kRate_hz;
    const double moves = t >= begin_s ? 1.0 : 0.0;
    imu.add({.t = at(t), .gyro_b = {0.0, 0.0, moves * rate}, .accel_b = {moves * accel, 0.0, 9.81}});
  }
  return imu;
}

Matrix6 covariance_of(double sigma_m, double sigma_rad) {
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m),
      Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return covariance;
}

/// Pose of a body that accelerates along x from `begin_s` on, with an error of vision of 0.1 mrad.
VisualPose pose_of(double t, double accel, double begin_s) {
  const double moving_s = std::max(t - begin_s, 0.0);
  return {.t = at(t),
          .T_w_b = Pose{exp_so3({0.0, 0.0, 1e-4 * std::sin(40.0 * t)}),
                        {0.5 * accel * moving_s * moving_s, 0.0, 0.0}},
          .covariance = covariance_of(0.002, 0.001)};
}

/// Whether the data is consistent in all frames of 2 s, if it and vision measure these accelerations from 1 s
/// on, and the gyroscope a rate that vision does not see.
bool stays_consistent(double measured, double seen, double rate = 0.0, bool is_confirmed = false) {
  ImuBuffer imu = samples_of(measured, 1.0, rate);
  InertialCheck check;
  bool consistent = true;
  for (double t = kFrame_s; t < 1.9; t += kFrame_s) {
    VisualPose pose = pose_of(t, seen, 1.0);
    pose.is_confirmed = is_confirmed;
    consistent &= check.update(pose, {}, kGravity_w, imu);
  }
  return consistent;
}

TEST(InertialError, IsTheAccelerationThatVisionDoesNotSee) {
  ImuBuffer imu = samples_of(1.0, 0.0);
  const VisualPose A = pose_of(0.5, 0.0, 0.0), B = pose_of(0.6, 0.0, 0.0), C = pose_of(0.7, 0.0, 0.0);
  const auto error = inertial_error(independent_poses(A, B, C), {}, kGravity_w, imu);
  ASSERT_TRUE(error);
  EXPECT_LT((error->accel_w - Eigen::Vector3d(1.0, 0.0, 0.0)).norm(), 1e-3);
  EXPECT_LT(error->gyro_b.norm(), 2e-3);
  EXPECT_FALSE(error->accel_is_explained());  // the data is the same in both intervals
}

TEST(InertialError, IsAbsentWithoutSamples) {
  ImuBuffer imu(0.05);
  const VisualPose A = pose_of(0.5, 0.0, 0.0), B = pose_of(0.6, 0.0, 0.0), C = pose_of(0.7, 0.0, 0.0);
  EXPECT_FALSE(inertial_error(independent_poses(A, B, C), {}, kGravity_w, imu));
}

/// A body that turns about x and accelerates, with the preintegrated samples of `imu`, at 0, 0.1 and 0.25 s.
struct TurningBody {
  ImuBuffer imu{0.05};
  std::array<Pose, 3> T_w_b;
};

TurningBody turning_body() {
  TurningBody body;
  NavState state{
      .t = at(0.0), .T_w_b = {exp_so3({0.3, -0.2, 0.5}), {1.0, 2.0, 0.5}}, .v_w = {0.8, -0.3, 0.1}};
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 60; ++i) {
    samples.push_back({.t = at(i / kRate_hz), .gyro_b = {1.2, 0.3, -0.4}, .accel_b = {1.0, -3.0, 10.5}});
    body.imu.add(samples.back());
  }
  const auto pose_after = [&](std::size_t count) {
    return propagate(state, std::vector(samples.begin(), samples.begin() + static_cast<long>(count)),
                     kGravity_w)
        .T_w_b;
  };
  body.T_w_b = {state.T_w_b, pose_after(21), pose_after(51)};
  return body;
}

/// Position and rotation of a camera that looks along x are hard to tell apart: their errors are correlated.
Matrix6 correlated_covariance() {
  Matrix6 root = Matrix6::Zero();
  root.diagonal() << 0.001, 0.002, 0.0015, 0.0008, 0.0005, 0.001;
  root(4, 2) = 0.0004;
  root(5, 1) = -0.0007;
  return root * root.transpose();
}

/// The pose with a random error of the covariance.
Pose disturbed(const Pose& pose, const Matrix6& covariance, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, 6, 1> e;
  for (int i = 0; i < 6; ++i) e[i] = normal(random);
  e = (covariance.llt().matrixL() * e).eval();
  return {(pose.q * exp_so3(e.tail<3>())).normalized(), pose.p + e.head<3>()};
}

/// Ratios of the claimed standard deviations to those of the errors of `draws` runs.
struct ClaimRatio {
  double accel = 0.0;
  double gyro = 0.0;
};

template <class Draw>
ClaimRatio claim_ratio(int draws, const Draw& draw) {
  Eigen::Matrix3d accel = Eigen::Matrix3d::Zero(), gyro = accel;
  double accel_claim = 0.0, gyro_claim = 0.0;
  for (int i = 0; i < draws; ++i) {
    const InertialError error = draw();
    accel += error.accel_w * error.accel_w.transpose() / draws;
    gyro += error.gyro_b * error.gyro_b.transpose() / draws;
    accel_claim += error.accel_sigma / draws;
    gyro_claim += error.gyro_sigma / draws;
  }
  return {accel_claim / largest_sigma(accel), gyro_claim / largest_sigma(gyro)};
}

// The standard deviation of 2000 draws has an error of 1 / sqrt(4000), 1.6 %; the largest of three is larger
// by chance, by less than 2 %: 8 % is three standard deviations of both.
constexpr int kDraws = 2000;
constexpr double kTolerance = 0.08;

TEST(InertialError, HasTheCovarianceOfIndependentPoses) {
  TurningBody body = turning_body();
  std::mt19937 random(1);
  const Matrix6 P = correlated_covariance();
  const ClaimRatio ratio = claim_ratio(kDraws, [&] {
    const VisualPose A{.t = at(0.0), .T_w_b = disturbed(body.T_w_b[0], P, random), .covariance = P};
    const VisualPose B{.t = at(0.1), .T_w_b = disturbed(body.T_w_b[1], P, random), .covariance = P};
    const VisualPose C{.t = at(0.25), .T_w_b = disturbed(body.T_w_b[2], P, random), .covariance = P};
    return *inertial_error(independent_poses(A, B, C), {}, kGravity_w, body.imu);
  });
  EXPECT_NEAR(ratio.accel, 1.0, kTolerance);
  EXPECT_NEAR(ratio.gyro, 1.0, kTolerance);
}

TEST(InertialError, HasTheCovarianceOfChainedPoses) {
  TurningBody body = turning_body();
  std::mt19937 random(2);
  const Matrix6 P = correlated_covariance();
  const VisualPose A{.t = at(0.0), .T_w_b = body.T_w_b[0]};
  const Pose T_A_B = body.T_w_b[0].inverse() * body.T_w_b[1];
  const Pose T_B_C = body.T_w_b[1].inverse() * body.T_w_b[2];
  const ClaimRatio ratio = claim_ratio(kDraws, [&] {
    const VisualPose B{.t = at(0.1), .T_w_b = A.T_w_b * disturbed(T_A_B, P, random), .covariance = P};
    const VisualPose C{.t = at(0.25), .T_w_b = B.T_w_b * disturbed(T_B_C, P, random), .covariance = P};
    return *inertial_error(chained_poses(A, B, C), {}, kGravity_w, body.imu);
  });
  EXPECT_NEAR(ratio.accel, 1.0, kTolerance);
  EXPECT_NEAR(ratio.gyro, 1.0, kTolerance);
}

TEST(InertialError, ContainsTheDirectionOfGravityInAnUncertainBody) {
  // At rest with T1 = T2 = T / 2, f1 = f2 = -g T / 4: the horizontal error by the roll angles of A and B is
  // 2 / T * g T / 4 * (theta_A + theta_B), with a standard deviation of g / sqrt(2) times that of an angle.
  ImuBuffer imu = samples_of(0.0, 0.0);
  VisualPose A = pose_of(0.5, 0.0, 0.0), B = pose_of(0.6, 0.0, 0.0), C = pose_of(0.7, 0.0, 0.0);
  for (VisualPose* pose : {&A, &B, &C}) pose->covariance = covariance_of(0.0, 0.002);
  const auto error = inertial_error(independent_poses(A, B, C), {}, kGravity_w, imu);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->accel_sigma, 9.81 / std::sqrt(2.0) * 0.002, 1e-4);
}

TEST(InertialCheck, AcceptsAMotionThatBothMeasure) { EXPECT_TRUE(stays_consistent(5.0, 5.0)); }

TEST(InertialCheck, RejectsDataThatChangesWithoutAMotion) { EXPECT_FALSE(stays_consistent(8.0, 0.0)); }

TEST(InertialCheck, BlamesVisionForAMotionWithoutAChangeOfTheData) {
  EXPECT_TRUE(stays_consistent(0.0, 8.0));  // a person moves in front of the camera
}

/// A gyroscope that vibrates explains no error of the accelerometer. With that a person in front of a cart
/// was followed (occluder:start=4,duration=3,amount=0.8 on corridor: 0.9 m).
TEST(InertialCheck, BlamesVisionWhileTheOtherSensorVibrates) {
  EXPECT_TRUE(stays_consistent(0.0, 0.0, 0.08));
  EXPECT_TRUE(stays_consistent(0.0, 8.0, 0.08));
  EXPECT_FALSE(stays_consistent(0.0, 0.0, 0.5));
}

/// After a jump of the clock the data of both sensors is wrong, that of one of them more clearly.
TEST(InertialCheck, RejectsDataOfBothSensorsIfOldPointsConfirmVision) {
  EXPECT_FALSE(stays_consistent(0.0, 8.0, 0.08, true));
  EXPECT_TRUE(stays_consistent(0.0, 8.0, 0.0, true));
}

/// Data and vision of a body at rest, which agree.
struct AgreeingData {
  ImuBuffer imu = samples_of(0.0, 1.0);
  InertialCheck check;
  double t = 0.0;

  /// @return whether the data is consistent after that many frames
  bool update(int frames) {
    for (int i = 0; i < frames; ++i) check.update(pose_of(t += kFrame_s, 0.0, 1.0), {}, kGravity_w, imu);
    return check.is_consistent();
  }
};

TEST(InertialCheck, AcceptsDataAgainAfterSixFramesOfAgreementUnlessItIsHeld) {
  AgreeingData data;
  static_cast<void>(data.update(5));  // three poses at least 50 ms apart are known from the fifth on
  data.check.contradict();
  EXPECT_FALSE(data.update(5));
  EXPECT_TRUE(data.update(1));
  data.check.contradict();
  data.check.hold(true);
  EXPECT_FALSE(data.update(8));
  data.check.hold(false);
  EXPECT_TRUE(data.update(1));
}

/// A gap in the stamps may be a jump of the clock.
TEST(InertialCheck, DoubtsDataAfterAGapUntilItAgreesWithVision) {
  AgreeingData data;
  EXPECT_TRUE(data.update(8));
  data.check.doubt(at(data.t));
  EXPECT_FALSE(data.update(5));
  EXPECT_TRUE(data.update(1));
}

/// A camera at rest, of a low rate or before a crowd is not compared.
TEST(InertialCheck, ADoubtThatNothingConfirmsEndsAfterASecond) {
  InertialCheck check;
  check.doubt(at(1.0));
  check.doubt(at(1.5));
  check.end_old_doubt(at(1.99));
  EXPECT_FALSE(check.is_consistent());
  check.end_old_doubt(at(2.01));
  EXPECT_TRUE(check.is_consistent());
  check.doubt(at(3.0));
  check.contradict();
  check.end_old_doubt(at(5.0));
  EXPECT_FALSE(check.is_consistent());
}

}  // namespace
}  // namespace stillpoint
