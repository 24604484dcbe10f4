// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/consistency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/simulated/located_claims.h"
#include "tests/support/simulated/smooth_path.h"

namespace stillpoint::eval {
namespace {

constexpr std::size_t kFrames = 100;  // at 10 Hz
constexpr std::size_t kFault = 40;    // frames 40 to 49
constexpr double kClaimed_m = 0.01;

class HonestyTest : public testing::Test {
 protected:
  const Trajectory gt_ = test::smooth_path(kFrames, 0.1);
  const std::vector<TimeSpan> fault_{{gt_.poses[kFault].t, gt_.poses[kFault + 10].t}};
  std::vector<ClaimedPose> claims_ = test::located_claims(gt_, {.sigma_m = kClaimed_m, .sigma_rad = 0.001});

  void displace(std::size_t begin, std::size_t end, double metres) {
    for (std::size_t i = begin; i < end; ++i) claims_[i].T_w_c.p.x() += metres;
  }
  void claim(std::size_t begin, std::size_t end, PoseClaim claim) {
    for (std::size_t i = begin; i < end; ++i) claims_[i].claim = claim;
  }
  [[nodiscard]] Honesty scored() const { return honesty(gt_, claims_, fault_).value(); }
};

TEST_F(HonestyTest, OfAPerfectRunIsPerfect) {
  const Honesty result = scored();
  EXPECT_EQ(result.false_confidence, 0.0);
  EXPECT_EQ(result.missed_availability, 0.0);
  EXPECT_FALSE(result.time_to_detect_s);
  EXPECT_EQ(result.time_to_recover_s, 0.0);
  EXPECT_NEAR(*result.error_after_recovery_m, 0.0, 1e-9);
}

TEST_F(HonestyTest, CountsWrongPosesThatAreCalledLocated) {
  displace(kFault, kFault + 10, 0.2);
  claim(kFault + 5, kFault + 10, PoseClaim::kLost);
  const Honesty result = scored();
  EXPECT_DOUBLE_EQ(result.false_confidence, 0.05);  // 5 of 100
  EXPECT_NEAR(*result.time_to_detect_s, 0.5, 1e-9);
  EXPECT_EQ(result.time_to_recover_s, 0.0);
}

TEST_F(HonestyTest, AcceptsErrorsWithinThreeClaimedStandardDeviations) {
  displace(kFault, kFault + 10, 0.2);
  for (std::size_t i = kFault; i < kFault + 10; ++i) claims_[i].sigma_m = 0.07;
  EXPECT_EQ(scored().false_confidence, 0.0);
}

TEST_F(HonestyTest, CountsGoodPosesThatAreCalledLost) {
  claim(0, 3, PoseClaim::kNone);
  claim(kFault, kFault + 4, PoseClaim::kLost);
  claim(kFault + 4, kFault + 6, PoseClaim::kDeadReckoning);
  EXPECT_DOUBLE_EQ(scored().missed_availability, 0.04);
}

TEST_F(HonestyTest, AnImperfectionFromTheFirstFrameOnIsScoredWithoutAReference) {
  // Half of the frames are displaced by 0.4 m: after the alignment of all, each is wrong by about 0.2 m.
  displace(0, kFrames / 2, 0.4);
  const std::vector<TimeSpan> always{{gt_.poses.front().t, after(gt_.poses.back().t, 1.0)}};
  const std::optional<Honesty> result = honesty(gt_, claims_, always);
  ASSERT_TRUE(result);
  EXPECT_GT(result->false_confidence, 0.9);
  EXPECT_EQ(honesty(gt_, claims_, {})->false_confidence, 0.0);
}

TEST_F(HonestyTest, ARotatedWorldIsNotWrongWithAnImperfectionFromTheFirstFrameOn) {
  // The positions say that the world is turned by 0.1 rad, the attitudes that it is not: errors of the
  // alignment.
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()));
  for (ClaimedPose& claim : claims_) claim.T_w_c.p = turn * claim.T_w_c.p;
  const std::vector<TimeSpan> always{{gt_.poses.front().t, after(gt_.poses.back().t, 1.0)}};
  EXPECT_EQ(honesty(gt_, claims_, always)->false_confidence, 0.0);
}

TEST_F(HonestyTest, AWrongScaleThatIsClaimedIsNotWrongAnywhereOnThePath) {
  // The scale is off by 5 %, and claimed to be known to 5 % or to 0.2 %. The claims are relative to the first
  // pose, which the alignment of all poses moves by more than 5 cm.
  const Eigen::Vector3d origin = gt_.poses.front().T_w_f.p;
  for (ClaimedPose& claim : claims_) claim.T_w_c.p = origin + 1.05 * (claim.T_w_c.p - origin);
  const std::vector<TimeSpan> always{{gt_.poses.front().t, after(gt_.poses.back().t, 1.0)}};
  const auto false_confidence = [&](double scale_sigma) {
    for (std::size_t i = 0; i < kFrames; ++i)
      claims_[i].sigma_m = scale_sigma * (gt_.poses[i].T_w_f.p - origin).norm();
    return honesty(gt_, claims_, always)->false_confidence;
  };
  EXPECT_EQ(false_confidence(0.05), 0.0);
  EXPECT_GT(false_confidence(0.002), 0.5);
}

TEST_F(HonestyTest, APoseOfALaterSegmentIsNoRecovery) {
  claim(kFault, kFault + 10, PoseClaim::kLost);
  displace(kFault, kFrames, 3.0);
  for (std::size_t i = kFault + 10; i < kFrames; ++i) claims_[i].segment = 1;
  const Honesty result = scored();
  EXPECT_EQ(result.false_confidence, 0.0);
  EXPECT_EQ(result.missed_availability, 0.0);
  EXPECT_EQ(result.time_to_detect_s, 0.0);
  EXPECT_FALSE(result.time_to_recover_s);
}

TEST_F(HonestyTest, MeasuresTheErrorAfterTheRecovery) {
  displace(kFault, kFault + 20, 0.3);
  displace(kFault + 20, kFrames, 0.03);
  const Honesty result = scored();
  EXPECT_NEAR(*result.time_to_recover_s, 1.0, 1e-9);  // ten frames after the end of the fault
  EXPECT_NEAR(*result.error_after_recovery_m, 0.03, 1e-9);
}

TEST_F(HonestyTest, TheClaimIsThatOfLocatedFramesWithACovariance) {
  EXPECT_DOUBLE_EQ(*claimed_three_sigma_m(claims_), 3.0 * kClaimed_m);
  for (std::size_t i = 0; i < 60; ++i) claims_[i].sigma_m = i < 30 ? 0.0 : 0.02;
  claim(60, 95, PoseClaim::kDeadReckoning);
  EXPECT_DOUBLE_EQ(*claimed_three_sigma_m(claims_), 0.06);
  claim(0, kFrames, PoseClaim::kLost);
  EXPECT_FALSE(claimed_three_sigma_m(claims_));
}

TEST_F(HonestyTest, NeedsAReferenceBeforeTheFault) {
  claim(0, kFault - 5, PoseClaim::kNone);
  EXPECT_FALSE(honesty(gt_, claims_, fault_));
}

/// A path that is straight, or stands, until the fault at 4 s, and then goes 12 m away; the estimate has
/// errors of 2 mm and 0.1 deg.
double planted_false_confidence(double speed_before, std::size_t first) {
  Trajectory gt;
  for (std::size_t i = 0; i < kFrames; ++i) {
    const double t = 0.1 * static_cast<double>(i);
    const double later = std::max(0.0, t - 4.0);
    const Eigen::Vector3d p(speed_before * t, 2.0 * later, later * std::sin(later));
    gt.poses.push_back({from_seconds(t), Pose{exp_so3({0.1 * std::sin(t), 0.2 * later, 0.1 * t}), p}});
  }
  std::vector<ClaimedPose> claims = test::located_claims(gt, {.sigma_m = 0.005, .sigma_rad = 0.002});
  for (std::size_t i = 0; i < kFrames; ++i) {
    const auto noise = [&](int k) { return std::sin(37.7 * static_cast<double>(i) + 11.3 * k * k); };
    claims[i].T_w_c.p += 0.002 * Eigen::Vector3d(noise(1), noise(2), noise(3));
    claims[i].T_w_c.q = claims[i].T_w_c.q * exp_so3(0.0017 * Eigen::Vector3d(noise(4), noise(5), noise(6)));
    if (i < first) claims[i].claim = PoseClaim::kNone;
  }
  return honesty(gt, claims, std::vector<TimeSpan>{{gt.poses[kFault].t, gt.poses[kFault + 5].t}})
      .value()
      .false_confidence;
}

TEST(HonestyAlignment, OfStraightStandingAndFewPosesIsThatOfTheOrientations) {
  EXPECT_EQ(planted_false_confidence(0.5, 0), 0.0);            // straight
  EXPECT_EQ(planted_false_confidence(0.0, 0), 0.0);            // standing
  EXPECT_EQ(planted_false_confidence(0.5, kFault - 10), 0.0);  // ten poses
}

}  // namespace
}  // namespace stillpoint::eval
