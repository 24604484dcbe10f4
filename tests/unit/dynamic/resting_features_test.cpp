// SPDX-License-Identifier: BSD-3-Clause
#include "core/dynamic/resting_features.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

constexpr double kFocal_px = 500.0;
constexpr int kPictures = 3;
constexpr double kStray_px = 1.5;

/// One picture of feature 7, seen by a camera at the origin of the world.
ConsistencyView picture(double u_px, double depth) {
  return {.T_w_c = {Pose()},
          .focal_px = kFocal_px,
          .features = {{.id = 7, .first = 0, .count = 1}},
          .observations = {{.frame = 0, .bearing = {u_px / kFocal_px, 0.0}, .depth = depth}}};
}

TEST(RestingFeatures, RestAfterSoManyPicturesAtOnePlace) {
  RestingFeatures resting(kPictures, kStray_px);
  EXPECT_TRUE(resting.update(picture(10.0, 2.0)).empty());  // arrives
  EXPECT_TRUE(resting.update(picture(11.0, 2.0)).empty());  // 1 px off: stays
  EXPECT_TRUE(resting.update(picture(9.0, 2.0)).empty());
  EXPECT_EQ(resting.update(picture(10.0, 2.0)), std::vector<std::int64_t>{7});
}

TEST(RestingFeatures, DoNotRestWhileTheyCreep) {
  RestingFeatures resting(kPictures, kStray_px);
  // 0.6 px a picture: the third is 1.8 px from where the count began, so it begins anew.
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(resting.update(picture(0.6 * i, 2.0)).empty()) << i;
}

TEST(RestingFeatures, StayWithoutDepthButDoNotArriveWithout) {
  RestingFeatures resting(kPictures, kStray_px);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(resting.update(picture(10.0, 0.0)).empty());
  EXPECT_TRUE(resting.update(picture(10.0, 2.0)).empty());
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(resting.update(picture(10.0, 0.0)).empty());
  EXPECT_EQ(resting.update(picture(10.0, 0.0)).size(), 1U);
}

TEST(RestingFeatures, AreSeenFromACameraThatMoves) {
  RestingFeatures resting(kPictures, kStray_px);
  std::vector<std::int64_t> at_rest;
  for (int i = 0; i < 4; ++i) {
    // The camera goes 0.1 m to the right each picture; a still point 2 m away goes 0.1 / 2 * 500 = 25 px
    // left.
    ConsistencyView view = picture(100.0 - 25.0 * i, 2.0);
    view.T_w_c = {Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.1 * i, 0.0, 0.0))};
    at_rest = resting.update(view);
  }
  EXPECT_EQ(at_rest.size(), 1U);
}

TEST(RestingFeatures, AreForgottenWhenAPictureMissesThem) {
  RestingFeatures resting(kPictures, kStray_px);
  for (int i = 0; i < 4; ++i) (void)resting.update(picture(10.0, 2.0));
  (void)resting.update({.T_w_c = {Pose()}, .focal_px = kFocal_px, .features = {}, .observations = {}});
  EXPECT_TRUE(resting.update(picture(10.0, 2.0)).empty());
}

}  // namespace
}  // namespace stillpoint
