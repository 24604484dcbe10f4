// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/vision/vision_assessment.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

VisionAssessment assessment(int inliers, int features) {
  return {.features = features, .inliers = inliers, .sigma_m = 1e-3, .sigma_rad = 1e-3};
}

TEST(VisionAssessment, ContradictsInertialDataWithMostOfTheKnownFeatures) {
  EXPECT_TRUE(assessment(100, 110).may_contradict_imu(130));
  EXPECT_TRUE(assessment(40, 45).may_contradict_imu(130));
  EXPECT_FALSE(assessment(60, 110).may_contradict_imu(130));
  VisionAssessment weak = assessment(100, 110);
  weak.sigma_m = 1.0;
  EXPECT_FALSE(weak.may_contradict_imu(130));
}

/// Numbers of a person who covers 80 % of the image and is followed by 18 of 19 known features (fault
/// occluder:start=4,duration=3,amount=0.8 on walking_xyz): the estimate was 0.2 m off.
TEST(VisionAssessment, DoesNotContradictInertialDataWithAFewOfTheTrackedFeatures) {
  EXPECT_FALSE(assessment(18, 19).may_contradict_imu(130));
  EXPECT_TRUE(assessment(18, 19).may_contradict_imu(30));
}

}  // namespace
}  // namespace stillpoint
