// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/feature_detector.h"

#include <gtest/gtest.h>

#include <limits>

namespace stillpoint {
namespace {

FeatureMask empty_mask() {
  FeatureMask mask;
  mask.clear(cv::Size(100, 80));
  return mask;
}

TEST(FeatureMask, IsFreeOnlyInsideTheImage) {
  const FeatureMask mask = empty_mask();
  EXPECT_TRUE(mask.is_free({0.0F, 0.0F}));
  EXPECT_TRUE(mask.is_free({99.4F, 79.4F}));   // rounds to the last pixel
  EXPECT_FALSE(mask.is_free({99.6F, 79.0F}));  // rounds to outside the image
  EXPECT_FALSE(mask.is_free({-0.6F, 10.0F}));
}

TEST(FeatureMask, CircleOccupiesItsDisc) {
  FeatureMask mask = empty_mask();
  mask.occupy_circle({50.2F, 40.0F}, 10);
  EXPECT_FALSE(mask.is_free({50.0F, 40.0F}));
  EXPECT_FALSE(mask.is_free({60.0F, 40.0F}));
  EXPECT_TRUE(mask.is_free({61.0F, 40.0F}));
  EXPECT_FALSE(mask.is_free({57.0F, 47.0F}));  // 9.9 px away
  EXPECT_TRUE(mask.is_free({58.0F, 48.0F}));   // 11.3 px away
}

TEST(FeatureMask, FirstOccupantWins) {
  FeatureMask mask = empty_mask();
  EXPECT_TRUE(mask.try_occupy({50.0F, 40.0F}, 10));
  EXPECT_FALSE(mask.try_occupy({55.0F, 40.0F}, 10));
  EXPECT_TRUE(mask.is_free({63.0F, 40.0F})) << "a rejected try_occupy must not occupy its circle";
  EXPECT_TRUE(mask.try_occupy({61.0F, 40.0F}, 10));
}

TEST(FeatureMask, RadiusZeroOccupiesNothing) {
  FeatureMask mask = empty_mask();
  mask.occupy_circle({50.0F, 40.0F}, 0);
  EXPECT_TRUE(mask.is_free({50.0F, 40.0F}));
}

TEST(FeatureMask, ClearFreesAllPixels) {
  FeatureMask mask = empty_mask();
  mask.occupy_circle({50.0F, 40.0F}, 10);
  mask.clear(cv::Size(100, 80));
  EXPECT_TRUE(mask.is_free({50.0F, 40.0F}));
}

}  // namespace
}  // namespace stillpoint
