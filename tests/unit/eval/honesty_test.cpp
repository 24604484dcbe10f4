// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/consistency.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace stillpoint::eval
