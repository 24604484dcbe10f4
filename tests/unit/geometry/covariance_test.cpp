// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/covariance.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace stillpoint {
namespace {

TEST(LargestSigma, IsTheStandardDeviationAlongTheLeastCertainDirection) {
  // Variances 1, 4 and 9 along rotated axes: the largest standard deviation is 3.
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).matrix();
  const Eigen::Matrix3d covariance = R * Eigen::Vector3d(1.0, 4.0, 9.0).asDiagonal() * R.transpose();
  EXPECT_NEAR(largest_sigma(covariance), 3.0, 1e-12);
}

TEST(LargestSigma, IsZeroForTheZeroMatrix) {
  EXPECT_EQ(largest_sigma(Eigen::Matrix3d::Zero()), 0.0);
  EXPECT_EQ(largest_sigma(-Eigen::Matrix3d::Identity()), 0.0);
}

}  // namespace
}  // namespace stillpoint
