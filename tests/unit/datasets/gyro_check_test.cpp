// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/gyro_check.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/geometry/so3.h"

namespace stillpoint::datasets {
namespace {

constexpr double kDegrees = 180.0 / M_PI;

/// Rates of 0.5 rad/s about all axes, at periods of 2 to 5 s.
Eigen::Vector3d rate_at(double t) {
  return 0.5 * Eigen::Vector3d(std::sin(1.3 * t), std::cos(2.1 * t), std::sin(3.1 * t + 0.5));
}

/// A gyroscope with 200, a truth of the camera with 100, and images with 30 per second over 12 s.
/// @param late_s of the stamps of the truth
SequenceInfo turning_sequence(double late_s = 0.0) {
  SequenceInfo info;
  info.rig.has_imu = true;
  info.rig.T_b_c.q = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized());
  Eigen::Quaterniond q_w_b = Eigen::Quaterniond::Identity();
  for (int i = 0; i < 2400; ++i) {
    const double t = 0.005 * i;
    info.imu.push_back({.t = from_seconds(10.0 + t), .gyro_b = rate_at(t), .accel_b = {0.0, -9.8, 0.0}});
    if (i % 2 == 0)
      info.ground_truth.trajectory.poses.push_back(
          {from_seconds(10.0 + t + late_s), Pose{.q = q_w_b * info.rig.T_b_c.q}});
    q_w_b = (q_w_b * exp_so3(0.005 * rate_at(t + 0.0025))).normalized();
  }
  for (int i = 0; i < 360; ++i) info.frame_times.push_back(from_seconds(10.0 + i / 30.0));
  return info;
}

std::string finding_of(const SequenceInfo& info) { return gyro_truth_finding(info).value_or(""); }

TEST(GyroCheck, FindsNothingInARecordingThatAgrees) {
  SequenceInfo info = turning_sequence();
  EXPECT_EQ(finding_of(info), "");
  for (ImuSample& sample : info.imu) sample.gyro_b += Eigen::Vector3d(0.05, -0.1, 0.02);  // a bias
  EXPECT_EQ(finding_of(info), "");
  for (std::size_t i = 300; i < 340; ++i) {  // 0.4 s in which the truth is turned
    Eigen::Quaterniond& q = info.ground_truth.trajectory.poses[i].T_w_f.q;
    q = q * exp_so3(Eigen::Vector3d(0.0, 1.0, 0.0));
  }
  EXPECT_EQ(finding_of(info), "");
}

TEST(GyroCheck, SaysByHowMuchSwappedAndInvertedAxesDiffer) {
  SequenceInfo info = turning_sequence();
  for (ImuSample& sample : info.imu) sample.gyro_b.x() *= -1.0;
  const std::string inverted = finding_of(info);
  EXPECT_NE(inverted.find("over 11 windows of 1 s"), std::string::npos) << inverted;
  EXPECT_NE(inverted.find("(x, y, z) <- (-x, y, z)"), std::string::npos) << inverted;
  info = turning_sequence();
  for (ImuSample& sample : info.imu) std::swap(sample.gyro_b.x(), sample.gyro_b.z());
  EXPECT_NE(finding_of(info).find("(x, y, z) <- (z, y, x)"), std::string::npos) << finding_of(info);
}

TEST(GyroCheck, NamesTheRotationBetweenBothFrames) {
  SequenceInfo info = turning_sequence();
  info.rig.T_b_c.q = info.rig.T_b_c.q * exp_so3(Eigen::Vector3d(0.0, 0.0, 40.0 / kDegrees));
  EXPECT_NE(finding_of(info).find("turned by 40 deg"), std::string::npos) << finding_of(info);
}

TEST(GyroCheck, NamesARateOfAnotherUnit) {
  SequenceInfo info = turning_sequence();
  for (ImuSample& sample : info.imu) sample.gyro_b *= 2.0;
  EXPECT_NE(finding_of(info).find("2.00 times as far"), std::string::npos) << finding_of(info);
  for (ImuSample& sample : info.imu) sample.gyro_b *= 0.5 * kDegrees;  // imu_unit_findings names it
  EXPECT_EQ(finding_of(info), "");
}

TEST(GyroCheck, NamesTheOffsetOfTheClocks) {
  for (const double late_s : {0.08, -0.08}) {
    const std::string finding = finding_of(turning_sequence(late_s));
    EXPECT_NE(finding.find(late_s > 0.0 ? "80 ms late" : "80 ms early"), std::string::npos) << finding;
  }
  SequenceInfo known = turning_sequence(-0.08);  // all of the camera 80 ms early, as stated
  for (Timestamp& t : known.frame_times) t = after(t, -0.08);
  known.rig.time_offset_s = 0.08;
  EXPECT_EQ(finding_of(known), "");
}

TEST(GyroCheck, HasNothingToCompareWithoutRotationOrTruth) {
  SequenceInfo info = turning_sequence();
  for (StampedPose& pose : info.ground_truth.trajectory.poses) pose.T_w_f.q.setIdentity();
  EXPECT_EQ(finding_of(info), "");
  info.ground_truth.trajectory.poses.clear();
  EXPECT_EQ(finding_of(info), "");
  SequenceInfo without_imu = turning_sequence();
  without_imu.imu.clear();
  EXPECT_EQ(finding_of(without_imu), "");
}

}  // namespace
}  // namespace stillpoint::datasets
