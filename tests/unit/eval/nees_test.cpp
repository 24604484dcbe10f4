// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/consistency.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/error.h"
#include "core/geometry/so3.h"
#include "tests/support/simulated/located_claims.h"
#include "tests/support/simulated/smooth_path.h"

namespace stillpoint::eval {
namespace {

constexpr std::size_t kPoses = 60;  // at 10 Hz

TEST(Nees, IsTheSquaredErrorNormalizedByTheCovariance) {
  // 0.2 rad about x with a standard deviation of 0.1 rad: 4. 3 m along y with 1.5 m: 4.
  const Pose est{exp_so3({0.2, 0.0, 0.0}), {0.0, 3.0, 0.0}};
  const Nees result =
      nees(Pose{}, est, 0.01 * Eigen::Matrix3d::Identity(), 2.25 * Eigen::Matrix3d::Identity());
  EXPECT_NEAR(result.rotation, 4.0, 1e-9);
  EXPECT_NEAR(result.position, 4.0, 1e-12);
  EXPECT_THROW(static_cast<void>(nees(Pose{}, est, Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Identity())),
               InputError);
}

/// Sigmas of 0.1 m and 0.01 rad.
const ClaimedPose kClaimed{.position_covariance = 0.01 * Eigen::Matrix3d::Identity(),
                           .rotation_covariance = 1e-4 * Eigen::Matrix3d::Identity()};

TEST(MeanNees, IsRelativeToTheFirstPoseAndCountsFromThreeSecondsOn) {
  const Trajectory gt = test::smooth_path(kPoses, 0.1);
  std::vector<ClaimedPose> claims = test::located_claims(gt, kClaimed);
  EXPECT_NEAR(mean_nees(gt, claims)->position, 0.0, 1e-12);
  for (std::size_t i = 1; i < kPoses; ++i) {
    // 0.3 m and 0.03 rad are three standard deviations each: NEES 9, divided by 3.
    claims[i].T_w_c.p.x() += i < 30 ? 5.0 : 0.3;
    claims[i].T_w_c.q = Eigen::Quaterniond(exp_so3({0.0, i < 30 ? 1.0 : 0.03, 0.0})) * claims[i].T_w_c.q;
  }
  EXPECT_NEAR(mean_nees(gt, claims)->position, 3.0, 1e-6);
  EXPECT_NEAR(mean_nees(gt, claims)->rotation, 3.0, 1e-6);
}

TEST(MeanNees, NeedsLocatedPosesWithACovariance) {
  const Trajectory gt = test::smooth_path(kPoses, 0.1);
  std::vector<ClaimedPose> claims = test::located_claims(gt, kClaimed);
  EXPECT_FALSE(mean_nees({}, claims));
  for (std::size_t i = 30; i < 45; ++i) claims[i].position_covariance.setZero();
  for (std::size_t i = 45; i < kPoses; ++i) claims[i].claim = PoseClaim::kLost;
  EXPECT_FALSE(mean_nees(gt, claims));
}

/// Poses of a path with independent errors of the standard deviations 0.1 m and 0.01 rad, times `factor`.
std::vector<ClaimedPose> claims_with_errors(const Trajectory& gt, double factor) {
  std::vector<ClaimedPose> claims = test::located_claims(gt, kClaimed);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const auto draw = [&](double sigma) {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Eigen::Vector3d(factor * sigma * Eigen::Vector3d(x, y, z));
  };
  for (std::size_t i = 1; i < claims.size(); ++i) {
    claims[i].T_w_c.p += draw(0.1);
    claims[i].T_w_c.q = exp_so3(draw(0.01)) * claims[i].T_w_c.q;
  }
  return claims;
}

TEST(CovarianceScore, TellsConsistentFromOverconfidentClaims) {
  const Trajectory gt = test::smooth_path(1000, 0.1);
  const CovarianceScore right = covariance_score(gt, claims_with_errors(gt, 1.0)).value();
  const CovarianceScore overconfident = covariance_score(gt, claims_with_errors(gt, 3.0)).value();
  EXPECT_EQ(right.poses, 970U);
  for (const ClaimQuality& quality : {right.position, right.rotation}) {
    EXPECT_NEAR(quality.nees, 1.0, 0.1);
    EXPECT_LT(quality.nees_low, quality.nees);
    EXPECT_GT(quality.nees_high, quality.nees);
    EXPECT_NEAR(quality.within_3_sigma, 0.9973, 0.004);
  }
  // Means of (3 + 3 log(2 pi sigma^2)) / 2.
  EXPECT_NEAR(right.position.nll, 1.5 + 1.5 * std::log(2.0 * M_PI * 0.01), 0.15);
  EXPECT_NEAR(right.rotation.nll, 1.5 + 1.5 * std::log(2.0 * M_PI * 1e-4), 0.15);
  EXPECT_NEAR(overconfident.position.nees, 9.0, 0.9);
  EXPECT_GT(overconfident.position.nees, overconfident.position.nees_high);
  EXPECT_NEAR(overconfident.position.within_3_sigma, 0.683, 0.03);  // one standard deviation
  EXPECT_GT(overconfident.position.nll, right.position.nll);
}

TEST(CovarianceScore, TheIntervalIsThatOfTheChiSquareDistribution) {
  // 970 independent poses: 2910 degrees of freedom, of which 2.5 and 97.5 % are 1 -+ 1.96 sqrt(2 / 2910).
  const Trajectory gt = test::smooth_path(1000, 0.1);
  const ClaimQuality independent = covariance_score(gt, claims_with_errors(gt, 1.0))->position;
  EXPECT_NEAR(independent.nees_high - independent.nees_low, 2.0 * 1.96 * std::sqrt(2.0 / 2910.0), 0.04);
  // The same error in 50 poses after the other is one error.
  std::vector<ClaimedPose> claims = claims_with_errors(gt, 1.0);
  const std::vector<ClaimedPose> exact = test::located_claims(gt, kClaimed);
  for (std::size_t i = 50; i < claims.size(); ++i) {
    const std::size_t source = i - i % 50;
    claims[i].T_w_c.p = exact[i].T_w_c.p + (claims[source].T_w_c.p - exact[source].T_w_c.p);
  }
  const ClaimQuality dependent = covariance_score(gt, claims)->position;
  EXPECT_GT(dependent.nees_high - dependent.nees_low, 0.6);
}

TEST(CovarianceScore, ClaimsMayBeThoseInTheWorldOfTheTruth) {
  const Trajectory gt = test::smooth_path(kPoses, 0.1);
  std::vector<ClaimedPose> claims = test::located_claims(gt, kClaimed);
  for (std::size_t i = 0; i < kPoses; ++i) claims[i].T_w_c = gt.poses[i].T_w_f;
  claims[0].T_w_c.p.x() += 1.0;
  EXPECT_NEAR(covariance_score(gt, claims, ClaimOrigin::kWorld)->position.nees, 0.0, 1e-12);
  EXPECT_GT(covariance_score(gt, claims)->position.nees, 10.0);
}

}  // namespace
}  // namespace stillpoint::eval
