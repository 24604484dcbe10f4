// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/consistency.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace stillpoint::eval
