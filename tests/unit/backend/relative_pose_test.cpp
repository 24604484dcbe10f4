// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/monocular_structure.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "tests/support/random.h"

namespace stillpoint {
namespace {

constexpr double kThreshold = 1.0 / 500.0;  // 1 px

const Pose kTFirstSecond{exp_so3({0.05, -0.1, 0.02}), {0.3, -0.1, 0.2}};

/// Points 2-5 m in front of the first camera; every `outlier_every`-th is displaced by 0.1 in the second
/// image.
std::vector<BearingPair> pairs_of_points(int points, int outlier_every) {
  Random random(7);
  std::vector<BearingPair> pairs;
  for (int i = 0; i < points; ++i) {
    const Eigen::Vector2d first = random.uniform2({-0.5, -0.4}, {0.5, 0.4});
    const Eigen::Vector3d p_first = random.uniform(2.0, 5.0) * first.homogeneous();
    const Eigen::Vector3d p_second = kTFirstSecond.inverse() * p_first;
    const bool outlier = i % outlier_every == outlier_every - 1;
    pairs.push_back({first, p_second.hnormalized() + Eigen::Vector2d(0.0, outlier ? 0.1 : 0.0)});
  }
  return pairs;
}

TEST(RelativePose, FindsRotationAndDirectionDespiteOutliers) {
  const std::optional<RelativePose> found = estimate_relative_pose(pairs_of_points(80, 4), kThreshold, 15);
  ASSERT_TRUE(found);
  EXPECT_LT(log_so3(kTFirstSecond.q.conjugate() * found->T_first_second.q).norm(), 1e-4);
  EXPECT_LT((found->T_first_second.p - kTFirstSecond.p.normalized()).norm(), 1e-3);
  EXPECT_GE(found->inliers, 60);  // 80 minus 20 outliers, some of which may lie on their epipolar line
}

TEST(RelativePose, IsDeterministic) {
  const std::vector<BearingPair> pairs = pairs_of_points(80, 4);
  const std::optional<RelativePose> first = estimate_relative_pose(pairs, kThreshold, 15);
  const std::optional<RelativePose> second = estimate_relative_pose(pairs, kThreshold, 15);
  EXPECT_EQ(first->T_first_second.p, second->T_first_second.p);
}

TEST(RelativePose, RejectsFourPoints) {
  EXPECT_FALSE(estimate_relative_pose(pairs_of_points(4, 5), kThreshold, 4));
}

TEST(RelativePose, RejectsUnrelatedBearings) {
  std::vector<BearingPair> pairs = pairs_of_points(40, 41);
  Random random(9);
  for (BearingPair& pair : pairs) pair.second = {random.uniform(-0.5, 0.5), random.uniform(-0.4, 0.4)};
  EXPECT_FALSE(estimate_relative_pose(pairs, kThreshold, 30));
}

}  // namespace
}  // namespace stillpoint
