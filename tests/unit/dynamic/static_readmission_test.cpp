// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/moving_consistency.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

constexpr double kFocal_px = 500.0;
constexpr int kMinStaticFrames = 3;
constexpr double kStaticResidual_px = 1.5;

/// Observation of feature 7 by a camera at the world origin.
ConsistencyView view_of(double u_px, double depth) {
  return {.T_w_c = {Pose()},
          .focal_px = kFocal_px,
          .features = {{.id = 7, .first = 0, .count = 1}},
          .observations = {{.frame = 0, .bearing = {u_px / kFocal_px, 0.0}, .depth = depth}}};
}

TEST(StaticReadmission, ReadmitsAfterTheMinimumNumberOfStaticFrames) {
  StaticReadmission readmission(kMinStaticFrames, kStaticResidual_px);
  EXPECT_TRUE(readmission.update(view_of(10.0, 2.0)).empty());  // sets the anchor
  EXPECT_TRUE(readmission.update(view_of(11.0, 2.0)).empty());  // residual 1 px: static
  EXPECT_TRUE(readmission.update(view_of(9.0, 2.0)).empty());
  EXPECT_EQ(readmission.update(view_of(10.0, 2.0)), std::vector<std::int64_t>{7});
}

TEST(StaticReadmission, AWindowWithoutFramesReadmitsNothing) {
  StaticReadmission readmission(kMinStaticFrames, kStaticResidual_px);
  EXPECT_TRUE(readmission.update(ConsistencyView{}).empty());
}

TEST(StaticReadmission, DoesNotReadmitSlowlyMovingFeatures) {
  StaticReadmission readmission(kMinStaticFrames, kStaticResidual_px);
  // 0.6 px per frame: the third frame is 1.8 px from the anchor, which resets it.
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(readmission.update(view_of(0.6 * i, 2.0)).empty()) << i;
}

TEST(StaticReadmission, NeedsDepthForTheAnchorOnly) {
  StaticReadmission readmission(kMinStaticFrames, kStaticResidual_px);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(readmission.update(view_of(10.0, 0.0)).empty());
  EXPECT_TRUE(readmission.update(view_of(10.0, 2.0)).empty());
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(readmission.update(view_of(10.0, 0.0)).empty());
  EXPECT_EQ(readmission.update(view_of(10.0, 0.0)).size(), 1U);
}

TEST(StaticReadmission, AccountsForCameraMotion) {
  StaticReadmission readmission(kMinStaticFrames, kStaticResidual_px);
  std::vector<std::int64_t> readmitted;
  for (int i = 0; i < 4; ++i) {
    // The camera moves 0.1 m to the right per frame; a static point at 2 m moves 0.1 / 2 * 500 = 25 px left.
    ConsistencyView view = view_of(100.0 - 25.0 * i, 2.0);
    view.T_w_c = {Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.1 * i, 0.0, 0.0))};
    readmitted = readmission.update(view);
  }
  EXPECT_EQ(readmitted.size(), 1U);
}

TEST(StaticReadmission, RemovesFeaturesThatAreNotObserved) {
  StaticReadmission readmission(kMinStaticFrames, kStaticResidual_px);
  for (int i = 0; i < 4; ++i) (void)readmission.update(view_of(10.0, 2.0));
  (void)readmission.update({.T_w_c = {Pose()}, .focal_px = kFocal_px, .features = {}, .observations = {}});
  EXPECT_TRUE(readmission.update(view_of(10.0, 2.0)).empty());
}

}  // namespace
}  // namespace stillpoint
