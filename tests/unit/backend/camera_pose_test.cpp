// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/vision/camera_pose.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "tests/support/random.h"
#include "tests/support/simulated/window_world.h"

namespace stillpoint {
namespace {

const Pose kTwC{exp_so3({0.1, -0.2, 0.05}), {0.3, -0.1, 0.2}};

/// Points 2-5 m in front of the camera; every fourth observation is an outlier, off by 0.1 (55 px).
std::vector<PointObservation> observations_with_outliers() {
  Random random(7);
  std::vector<PointObservation> observations;
  for (int i = 0; i < 80; ++i) {
    const Eigen::Vector2d bearing = random.uniform2({-0.5, -0.4}, {0.5, 0.4});
    const Eigen::Vector3d p_w = kTwC * Eigen::Vector3d(random.uniform(2.0, 5.0) * bearing.homogeneous());
    const Eigen::Vector2d shift = i % 4 == 0 ? Eigen::Vector2d(0.1, 0.0) : Eigen::Vector2d::Zero();
    observations.push_back({p_w, bearing + shift});
  }
  return observations;
}

TEST(CameraPose, FindsThePoseDespiteOutliers) {
  const std::optional<CameraPose> found = estimate_camera_pose(observations_with_outliers(), Pose{}, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->inliers, 60);
  // The 20 outliers at 0.1 still have a Cauchy weight of (0.01/0.1)^2 = 1 %, against 60 inliers.
  EXPECT_LT((found->T_w_c.p - kTwC.p).norm(), 0.005);
}

TEST(CameraPose, ReturnsNothingWithTooFewObservations) {
  std::vector<PointObservation> few = observations_with_outliers();
  few.resize(7);
  EXPECT_FALSE(estimate_camera_pose(few, Pose{}, {}));
}

/// In a window of 0.4 s. A person who just came before the camera has newer points; an inertial sensor that
/// becomes wrong makes the old ones appear to move.
TEST(CameraPose, OldPointsWereObservedForAFifthOfASecondWhateverTheirLabel) {
  Window window = visual_window(5, 40);
  for (Landmark& landmark : window.landmarks) {
    landmark.dynamic = landmark.id < 20;
    if (landmark.id % 4 != 0) continue;
    landmark.host = 3;  // 0.1 s before the newest frame
    landmark.observations.erase(landmark.observations.begin(), landmark.observations.begin() + 3);
  }
  EXPECT_EQ(known_points(window, {}, {}).size(), 20u);
  EXPECT_EQ(old_points(window, {}, {}).size(), 30u);
}

}  // namespace
}  // namespace stillpoint
