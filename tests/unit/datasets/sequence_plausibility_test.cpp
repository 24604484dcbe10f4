// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sequence_plausibility.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/so3.h"

namespace stillpoint::datasets {
namespace {

constexpr double kFocal_px = 100.0;

SequenceInfo info_with_force(const Eigen::Vector3d& force_b) {
  SequenceInfo info;
  for (int i = 0; i < 10; ++i)
    info.imu.push_back({.t = {i * 10'000'000}, .gyro_b = {0, 0, 0}, .accel_b = force_b});
  return info;
}

TEST(GravityFinding, AnUprightCameraHasNone) {
  EXPECT_FALSE(gravity_finding(info_with_force({0.5, -9.8, 0.3})));
  EXPECT_FALSE(gravity_finding(SequenceInfo{}));
  SequenceInfo rotated = info_with_force({0.0, 0.0, 9.8});  // the z axis of the body points up
  rotated.rig.T_b_c.q =
      Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX());  // y of the camera is -z of the body
  EXPECT_FALSE(gravity_finding(rotated));
}

TEST(GravityFinding, SwappedAxesAndAnInvertedSignAreReported) {
  EXPECT_TRUE(gravity_finding(info_with_force({0.0, 9.8, 0.0})));
  EXPECT_TRUE(gravity_finding(info_with_force({-9.8, 0.0, 0.0})));
  EXPECT_NE(gravity_finding(info_with_force({0.0, 0.0, 9.8}))->find("swapped"), std::string::npos);
}

Frame frame_with_depth(std::uint16_t raw, double units_per_m) {
  Frame frame;
  frame.gray = cv::Mat::zeros(32, 32, CV_8UC1);
  frame.depth = cv::Mat(32, 32, CV_16UC1, cv::Scalar(raw));
  frame.depth_units_per_m = units_per_m;
  return frame;
}

TEST(DepthUnitFinding, MillimetersAreNotFiveThousandths) {
  SequenceInfo info;
  const auto finding_of = [&info](std::uint16_t raw, double units_per_m) {
    info.rig.depth_units_per_m = units_per_m;
    ImagePlausibility plausibility(info);
    plausibility.add(frame_with_depth(raw, units_per_m));
    return plausibility.depth_unit_finding();
  };
  EXPECT_FALSE(finding_of(2000, 1000.0));
  EXPECT_FALSE(finding_of(10000, 5000.0));
  EXPECT_NE(finding_of(1400, 5000.0)->find("scale = 1000 "), std::string::npos);   // 0.28 m instead of 1.4 m
  EXPECT_NE(finding_of(15000, 1000.0)->find("scale = 5000 "), std::string::npos);  // 15 m instead of 3 m
  EXPECT_NE(finding_of(3000, 100.0)->find("scale = 1000 "), std::string::npos);    // 30 m instead of 3 m
  EXPECT_FALSE(finding_of(0, 1000.0));
}

/// Frames at 30 Hz of a camera that turns about its y axis by 0.2 sin(3 t) rad, and a gyroscope at 200 Hz
/// whose stamps are late by `offset_s`, in the second half by `later_offset_s` if that is given.
std::optional<std::string> finding_of_clocks(double offset_s, int frames = 115, double later_offset_s = NAN) {
  SequenceInfo info;
  info.rig.camera.fx = kFocal_px;
  for (int i = 0; i < 1000; ++i) {
    const double t = 0.005 * i;
    const double delay_s = std::isnan(later_offset_s) || t < 2.4 ? offset_s : later_offset_s;
    info.imu.push_back({.t = from_seconds(t),
                        .gyro_b = {0.0, 0.6 * std::cos(3.0 * (t - delay_s)), 0.0},
                        .accel_b = {0, -9.8, 0}});
  }
  ImagePlausibility plausibility(info);
  for (int i = 15; i < 15 + frames; ++i) {
    const double t = i / 30.0;
    const double shift_px = -kFocal_px * 0.2 * std::sin(3.0 * t);
    Frame frame;
    frame.t = from_seconds(t);
    frame.gray = cv::Mat(8, 160, CV_8UC1);
    for (int column = 0; column < 160; ++column) {
      const double x = column - shift_px;
      frame.gray.col(column).setTo(
          cv::Scalar(128.0 + 60.0 * std::sin(0.11 * x) + 50.0 * std::sin(0.037 * x + 1.0)));
    }
    plausibility.add(frame);
  }
  return plausibility.clock_finding();
}

TEST(ClockFinding, TheOffsetIsThatOfTheBestCorrelation) {
  EXPECT_FALSE(finding_of_clocks(0.0));
  const std::optional<std::string> finding = finding_of_clocks(0.12);
  ASSERT_TRUE(finding);
  EXPECT_NE(finding->find("time_offset_s = 0.12"), std::string::npos) << *finding;
}

TEST(ClockFinding, NothingIsClaimedFromOneSecondOrIfTheHalvesDisagree) {
  EXPECT_FALSE(finding_of_clocks(0.12, 45));  // frames
  EXPECT_FALSE(finding_of_clocks(0.20, 115, 0.04));
}

/// A gyroscope whose rates are `factor` times those of a camera that turns by 0.2 sin(3 t) rad.
SequenceInfo info_with_rates(double factor, bool with_truth) {
  SequenceInfo info;
  for (int i = 0; i < 800; ++i) {
    const double t = 0.005 * i;
    const double noise = 0.02 * std::sin(97.0 * i);
    info.imu.push_back({.t = from_seconds(t),
                        .gyro_b = {factor * (0.6 * std::cos(3.0 * t) + noise), factor * noise, 0.0},
                        .accel_b = {0, -9.8, 0}});
    if (!with_truth) continue;
    const Eigen::Quaterniond q(Eigen::AngleAxisd(0.2 * std::sin(3.0 * t), Eigen::Vector3d::UnitX()));
    info.ground_truth.trajectory.poses.push_back({from_seconds(t), Pose{q, {0, 0, 0}}});
  }
  return info;
}

TEST(ImuUnitFindings, DegreesPerSecondAreFoundFromTheMotion) {
  EXPECT_TRUE(imu_unit_findings(info_with_rates(1.0, true)).empty());
  EXPECT_TRUE(imu_unit_findings(info_with_rates(1.0, false)).empty());
  EXPECT_TRUE(imu_unit_findings(SequenceInfo{}).empty());
  for (const bool with_truth : {true, false}) {
    const auto findings = imu_unit_findings(info_with_rates(180.0 / M_PI, with_truth));
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_NE(findings[0].find("deg/s"), std::string::npos);
  }
}

TEST(ImuUnitFindings, AccelerationsInUnitsOfGravityAreFound) {
  const auto findings = imu_unit_findings(info_with_force({0.0, -1.0, 0.0}));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_NE(findings[0].find("mean acceleration is 1.000"), std::string::npos);
}

/// A camera that moves along x by 2 cm per frame in front of a textured wall 1.5 m away, whose depth is read
/// with `factor` times the right number of units per meter.
std::optional<std::string> finding_of_depth(double factor, double step_m = 0.02) {
  SequenceInfo info;
  info.rig.camera = {.width = 160, .height = 120, .fx = 150.0, .fy = 150.0, .cx = 80.0, .cy = 60.0};
  info.rig.depth_units_per_m = 1000.0 * factor;
  for (int i = 0; i < 30; ++i)
    info.ground_truth.trajectory.poses.push_back(
        {from_seconds(i / 30.0), Pose{Eigen::Quaterniond::Identity(), {step_m * i, 0, 0}}});
  ImagePlausibility plausibility(info);
  for (int i = 0; i < 30; ++i) {
    Frame frame;
    frame.t = from_seconds(i / 30.0);
    frame.gray = cv::Mat(120, 160, CV_8UC1);
    frame.depth = cv::Mat(120, 160, CV_16UC1, cv::Scalar(1500));
    frame.depth_units_per_m = info.rig.depth_units_per_m;
    for (int row = 0; row < 120; ++row) {
      for (int column = 0; column < 160; ++column) {
        const double x = (column - 80) * 1.5 / 150.0 + step_m * i, y = (row - 60) * 1.5 / 150.0;
        frame.gray.at<std::uint8_t>(row, column) =
            static_cast<std::uint8_t>(128 + 50 * std::sin(23 * x + 3 * y) + 40 * std::sin(11 * x - 17 * y));
      }
    }
    plausibility.add(frame);
  }
  return plausibility.depth_scale_finding();
}

TEST(DepthScaleFinding, IsThatOfTheMotion) {
  EXPECT_FALSE(finding_of_depth(1.0));
  EXPECT_FALSE(finding_of_depth(5.0, 0.0));  // no motion
  const auto small = finding_of_depth(5.0);  // 0.3 m instead of 1.5 m
  ASSERT_TRUE(small);
  EXPECT_NE(small->find("scale = 1000 "), std::string::npos) << *small;
  const auto large = finding_of_depth(0.2);
  ASSERT_TRUE(large);
  EXPECT_NE(large->find("scale = 1000 "), std::string::npos) << *large;
}

/// Findings about a hand-held camera before a textured wall 1.5 m away, without ground truth: it turns about
/// x and y, and moves along x and y by some centimeters at 1 Hz.
struct MotionFindings {
  std::optional<std::string> gyro;
  std::optional<std::string> depth;
};

MotionFindings findings_of_motion(double gyro_factor, double depth_factor, double motion = 1.0) {
  const auto pose_at = [motion](double t) {
    const Eigen::Vector3d angle(0.05 * std::sin(4.0 * t), 0.08 * std::sin(5.0 * t), 0.0);
    return Pose{exp_so3(motion * angle),
                motion * Eigen::Vector3d(0.06 * std::sin(6.0 * t), 0.04 * std::sin(7.0 * t), 0.0)};
  };
  SequenceInfo info;
  info.rig.camera = {.width = 64, .height = 48, .fx = 60.0, .fy = 60.0, .cx = 32.0, .cy = 24.0};
  info.rig.depth_units_per_m = 1000.0 * depth_factor;
  constexpr double kStep_s = 0.005;
  for (int i = 0; i < 340; ++i) {
    const double t = kStep_s * i;
    const Pose before = pose_at(t - kStep_s), now = pose_at(t), behind = pose_at(t + kStep_s);
    const Eigen::Vector3d accel = (behind.p - 2.0 * now.p + before.p) / (kStep_s * kStep_s);
    info.imu.push_back(
        {.t = from_seconds(t),
         .gyro_b = gyro_factor * log_so3(before.q.conjugate() * behind.q) / (2.0 * kStep_s),
         .accel_b = now.q.conjugate() * (accel + Eigen::Vector3d(0.0, -9.81, 0.0))});  // y points down
  }
  ImagePlausibility plausibility(info);
  for (int i = 0; i < 36; ++i) {
    const double t = i / 30.0;
    const Pose T_w_c = pose_at(t);
    Frame frame{.t = from_seconds(t),
                .gray = cv::Mat(48, 64, CV_8UC1),
                .depth = cv::Mat(48, 64, CV_16UC1),
                .depth_units_per_m = info.rig.depth_units_per_m};
    for (int row = 0; row < 48; ++row) {
      for (int column = 0; column < 64; ++column) {
        const Eigen::Vector3d ray = T_w_c.q * Eigen::Vector3d((column - 32) / 60.0, (row - 24) / 60.0, 1.0);
        const double depth_m = (1.5 - T_w_c.p.z()) / ray.z();
        const Eigen::Vector3d p = T_w_c.p + depth_m * ray;
        frame.depth.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(1000.0 * depth_m);
        frame.gray.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(
            128 + 50 * std::sin(13 * p.x() + 3 * p.y()) + 40 * std::sin(7 * p.x() - 11 * p.y()));
      }
    }
    plausibility.add(frame);
  }
  return {.gyro = plausibility.gyro_unit_finding(), .depth = plausibility.depth_motion_finding()};
}

TEST(MotionFindings, UnitsAreFoundWithoutGroundTruth) {
  const MotionFindings right = findings_of_motion(1.0, 1.0);
  EXPECT_FALSE(right.gyro) << *right.gyro;
  EXPECT_FALSE(right.depth) << *right.depth;
  const MotionFindings small = findings_of_motion(180.0 / M_PI, 5.0);  // depth of 0.3 m
  // Half of these rates exceed any rotation by hand, which the samples alone tell.
  ASSERT_TRUE(small.depth);
  EXPECT_NE(small.depth->find("scale = 1000 "), std::string::npos) << *small.depth;
  const MotionFindings centimeters = findings_of_motion(1.0, 0.1);  // depth of 15 m
  ASSERT_TRUE(centimeters.depth);
  EXPECT_NE(centimeters.depth->find("scale = 1000 "), std::string::npos) << *centimeters.depth;
  const MotionFindings slow = findings_of_motion(180.0 / M_PI, 0.2, 0.15);
  ASSERT_TRUE(slow.gyro);
  EXPECT_NE(slow.gyro->find("deg/s"), std::string::npos) << *slow.gyro;
  ASSERT_TRUE(slow.depth);
  EXPECT_NE(slow.depth->find("scale = 1000 "), std::string::npos) << *slow.depth;
  const MotionFindings still = findings_of_motion(180.0 / M_PI, 5.0, 0.0);
  EXPECT_FALSE(still.gyro);
  EXPECT_FALSE(still.depth);
}

}  // namespace
}  // namespace stillpoint::datasets
