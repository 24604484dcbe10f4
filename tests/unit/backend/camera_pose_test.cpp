// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/camera_pose.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "tests/support/random.h"

namespace stillpoint {
namespace {

const Pose kTwC{exp_so3({0.1, -0.2, 0.05}), {0.3, -0.1, 0.2}};

/// Points 2-5 m before the camera; each fourth is where it is not, by 0.1 (55 px).
std::vector<PointSighting> sightings_with_movers() {
  Random random(7);
  std::vector<PointSighting> sightings;
  for (int i = 0; i < 80; ++i) {
    const Eigen::Vector2d bearing(random.uniform(-0.5, 0.5), random.uniform(-0.4, 0.4));
    const Eigen::Vector3d p_w = kTwC * Eigen::Vector3d(random.uniform(2.0, 5.0) * bearing.homogeneous());
    const Eigen::Vector2d shift = i % 4 == 0 ? Eigen::Vector2d(0.1, 0.0) : Eigen::Vector2d::Zero();
    sightings.push_back({p_w, bearing + shift});
  }
  return sightings;
}

TEST(CameraPose, FindsThePoseAmongMovingPoints) {
  const std::optional<CameraPose> found = estimate_camera_pose(sightings_with_movers(), Pose{}, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->inliers, 60);
  // The movers still pull with Cauchy weight (0.01/0.1)^2 = 1 %: 20 of them at 0.1 against 60 inliers.
  EXPECT_LT((found->T_w_c.p - kTwC.p).norm(), 0.005);
}

TEST(CameraPose, SaysNothingWithoutAgreement) {
  std::vector<PointSighting> few = sightings_with_movers();
  few.resize(7);
  EXPECT_FALSE(estimate_camera_pose(few, Pose{}, {}));
}

}  // namespace
}  // namespace stillpoint
