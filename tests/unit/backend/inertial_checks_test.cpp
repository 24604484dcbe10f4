// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/inertial_checks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

const Eigen::Vector3d kGravity_w(0.0, 0.0, -9.81);
constexpr double kRate_hz = 200.0;
constexpr double kFrame_s = 0.04;

Timestamp at(double seconds) { return after({}, seconds); }

/// Samples of a level body that accelerates along x from `begin_s` on.
ImuBuffer samples_of(double accel, double begin_s) {
  ImuBuffer imu(0.05);
  for (int i = 0; i <= 2.0 * kRate_hz; ++i) {
    const double t = i / kRate_hz;
    imu.add(
        {.t = at(t), .gyro_b = Eigen::Vector3d::Zero(), .accel_b = {t >= begin_s ? accel : 0.0, 0.0, 9.81}});
  }
  return imu;
}

/// Pose of a body that accelerates along x from `begin_s` on, with an error of vision of 0.1 mrad.
VisualPose pose_of(double t, double accel, double begin_s) {
  const double moving_s = std::max(t - begin_s, 0.0);
  return {.t = at(t),
          .T_w_b = Pose{exp_so3({0.0, 0.0, 1e-4 * std::sin(40.0 * t)}),
                        {0.5 * accel * moving_s * moving_s, 0.0, 0.0}},
          .sigma_m = 0.002,
          .sigma_rad = 0.001};
}

/// Whether the data is consistent in all frames of 2 s, if it and vision measure these accelerations from 1 s
/// on.
bool stays_consistent(double measured, double seen) {
  ImuBuffer imu = samples_of(measured, 1.0);
  InertialCheck check;
  bool consistent = true;
  for (double t = kFrame_s; t < 1.9; t += kFrame_s)
    consistent &= check.update(pose_of(t, seen, 1.0), {}, kGravity_w, imu);
  return consistent;
}

TEST(InertialError, IsTheAccelerationThatVisionDoesNotSee) {
  ImuBuffer imu = samples_of(1.0, 0.0);
  const VisualPose A = pose_of(0.5, 0.0, 0.0), B = pose_of(0.6, 0.0, 0.0), C = pose_of(0.7, 0.0, 0.0);
  const auto error = inertial_error({.A = A, .B = B, .C = C}, {}, kGravity_w, imu);
  ASSERT_TRUE(error);
  EXPECT_LT((error->accel_w - Eigen::Vector3d(1.0, 0.0, 0.0)).norm(), 1e-3);
  EXPECT_LT(error->gyro_b.norm(), 2e-3);
  EXPECT_FALSE(error->accel_is_explained());  // the data is the same in both intervals
}

TEST(InertialError, IsAbsentWithoutSamples) {
  ImuBuffer imu(0.05);
  const VisualPose A = pose_of(0.5, 0.0, 0.0), B = pose_of(0.6, 0.0, 0.0), C = pose_of(0.7, 0.0, 0.0);
  EXPECT_FALSE(inertial_error({.A = A, .B = B, .C = C}, {}, kGravity_w, imu));
}

TEST(InertialCheck, AcceptsAMotionThatBothMeasure) { EXPECT_TRUE(stays_consistent(5.0, 5.0)); }

TEST(InertialCheck, RejectsDataThatChangesWithoutAMotion) { EXPECT_FALSE(stays_consistent(8.0, 0.0)); }

TEST(InertialCheck, BlamesVisionForAMotionWithoutAChangeOfTheData) {
  EXPECT_TRUE(stays_consistent(0.0, 8.0));  // a person moves in front of the camera
}

TEST(InertialCheck, AcceptsDataAgainAfterSixFramesOfAgreementUnlessItIsHeld) {
  ImuBuffer imu = samples_of(0.0, 1.0);
  InertialCheck check;
  double t = 0.0;
  const auto update = [&](int frames) {
    for (int i = 0; i < frames; ++i) check.update(pose_of(t += kFrame_s, 0.0, 1.0), {}, kGravity_w, imu);
    return check.is_consistent();
  };
  static_cast<void>(update(5));  // three poses at least 50 ms apart are known from the fifth on
  check.contradict();
  EXPECT_FALSE(update(5));
  EXPECT_TRUE(update(1));
  check.contradict();
  check.hold(true);
  EXPECT_FALSE(update(8));
  check.hold(false);
  EXPECT_TRUE(update(1));
}

}  // namespace
}  // namespace stillpoint
