// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/vision/feature_views.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "tests/support/simulated/window_world.h"

namespace stillpoint {
namespace {

constexpr double kViewInterval_s = 0.1;  // of `visual_window`

/// The window of the frames up to `newest` >= 1.
Window window_up_to(int newest) {
  Window window = visual_window(newest + 1, 40);
  const Timestamp now = window.frames.back().state.t;
  window.frames.back().from_previous.emplace(ImuNoise{}, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  window.frames.back().from_previous->integrate({{.t = after(now, -kViewInterval_s)}, {.t = now}});
  return window;
}

FeatureViews::Options view_options() { return {.focal_px = 500.0, .history_s = 0.35}; }

/// The motion between two views of frames 1 and 2, found from the pose of frame 1.
std::optional<VisualPose> pose_of_second(FeatureViews& views, const Window& first, const Window& second) {
  EXPECT_TRUE(views.add(first));
  EXPECT_TRUE(views.add(second));
  const VisualPose before{.t = views[0].t, .T_w_b = views[0].T_w_b};
  return views.pose_after(before, 0, 1, second.T_b_c);
}

TEST(FeatureViews, FindTheMotionFromAWrongPrediction) {
  FeatureViews views(view_options());
  const Pose truth = window_up_to(2).frames.back().state.T_w_b;
  Window second = window_up_to(2);
  second.frames.back().state.T_w_b = second.frames.back().state.T_w_b * Pose{exp_so3({0.01, 0.0, 0.01}), {}};
  const std::optional<VisualPose> found = pose_of_second(views, window_up_to(1), second);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->features, 40);
  EXPECT_LT((found->T_w_b.p - truth.p).norm(), 1e-4);
  EXPECT_LT(found->T_w_b.q.angularDistance(truth.q), 1e-4);
}

TEST(FeatureViews, TheCovarianceOfAMotionIsThatOfTheBody) {
  // A camera 1 m before the body: its rotation moves the body.
  FeatureViews near(view_options()), far(view_options());
  const Window first = window_up_to(1), second = window_up_to(2);
  const std::optional<VisualPose> at_camera = pose_of_second(near, first, second);
  ASSERT_TRUE(at_camera);
  const Pose T_b_c{Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0}};
  const auto shifted = [&](Window window) {
    for (WindowFrame& frame : window.frames) frame.state.T_w_b = frame.state.T_w_b * T_b_c.inverse();
    window.T_b_c = T_b_c;
    return window;
  };
  const std::optional<VisualPose> at_body = pose_of_second(far, shifted(first), shifted(second));
  ASSERT_TRUE(at_body);
  const auto trace = [](const Matrix6& covariance, int row) {
    return covariance.diagonal().segment(row, 3).sum();
  };
  EXPECT_GT(trace(at_body->covariance, 0), trace(at_camera->covariance, 0));
  EXPECT_NEAR(trace(at_body->covariance, 3), trace(at_camera->covariance, 3), 1e-9);
}

TEST(FeatureViews, DynamicFeaturesAreLeftOutUnlessTheyWereRelabeledSince) {
  Window second = window_up_to(2);
  for (Landmark& landmark : second.landmarks) landmark.dynamic = landmark.id < 10;
  FeatureViews strict(view_options());
  EXPECT_EQ(pose_of_second(strict, window_up_to(1), second)->features, 30);
  FeatureViews::Options relabeled = view_options();
  relabeled.uses_relabeled = true;
  FeatureViews lenient(relabeled);
  EXPECT_EQ(pose_of_second(lenient, window_up_to(1), second)->features, 40);
}

TEST(FeatureViews, AMotionNeedsAPartOfTheTrackedFeatures) {
  Window first = window_up_to(1);
  for (Landmark& landmark : first.landmarks) landmark.dynamic = landmark.id < 20;
  FeatureViews::Options most = view_options();
  most.min_static_ratio = 0.6;
  FeatureViews views(most);
  EXPECT_FALSE(pose_of_second(views, first, window_up_to(2)));
}

TEST(FeatureViews, ADepthThatWasNotMeasuredIsThatOfTheLandmark) {
  const auto without_depth = [](int newest) {
    Window window = window_up_to(newest);
    for (Landmark& landmark : window.landmarks) {
      for (Observation& observation : landmark.observations) observation.depth = 0.0;
    }
    return window;
  };
  FeatureViews young(view_options());
  EXPECT_FALSE(pose_of_second(young, without_depth(2), without_depth(3)));
  FeatureViews triangulated(view_options());
  const Window second = without_depth(4);
  const std::optional<VisualPose> found = pose_of_second(triangulated, without_depth(3), second);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->features, 40);
  EXPECT_LT((found->T_w_b.p - second.frames.back().state.T_w_b.p).norm(), 1e-4);
}

TEST(FeatureViews, ConsistentMotionOfLessThanSevenTenthsIsNone) {
  for (const int moving : {8, 16}) {
    Window second = window_up_to(2);
    for (Landmark& landmark : second.landmarks) {
      if (landmark.id < moving) landmark.observations.back().bearing.x() += 0.1;
    }
    FeatureViews views(view_options());
    EXPECT_EQ(pose_of_second(views, window_up_to(1), second).has_value(), moving == 8);
  }
}

TEST(FeatureViews, KeepTheirHistoryAtAnInterval) {
  FeatureViews::Options sparse = view_options();
  sparse.min_interval_s = 0.15;
  FeatureViews views(sparse);
  EXPECT_TRUE(views.add(window_up_to(1)));
  EXPECT_FALSE(views.add(window_up_to(2)));
  EXPECT_TRUE(views.add(window_up_to(3)));
  EXPECT_EQ(views.before(views[1].t, 0.15), 0u);
  EXPECT_FALSE(views.before(views[1].t, 0.25));
  EXPECT_TRUE(views.add(window_up_to(5)));  // 0.4 s after the first one, which is dropped
  EXPECT_EQ(views.size(), 2u);
  EXPECT_TRUE(views.add(window_up_to(9)));  // after a pause longer than the history
  EXPECT_EQ(views.size(), 1u);
}

}  // namespace
}  // namespace stillpoint
