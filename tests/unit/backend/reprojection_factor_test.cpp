// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/reference/reprojection_factor.h"

#include <gtest/gtest.h>

#include "core/geometry/pose.h"
#include "core/geometry/so3.h"
#include "tests/support/numeric_jacobian.h"

namespace stillpoint {
namespace {

std::vector<double> block(const Pose& T) {
  return {T.p.x(), T.p.y(), T.p.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w()};
}

const Pose kTwBi{exp_so3({0.1, -0.2, 0.3}), {0.1, 0.2, 0.3}};
const Pose kTwBj{exp_so3({0.15, -0.1, 0.25}), {0.3, 0.1, 0.5}};
const Pose kTbC{exp_so3({0.02, 0.01, -0.03}), {0.02, -0.01, 0.05}};
constexpr double kInverseDepth = 0.5;  // [1/m]

ReprojectionMeasurement measurement() {
  return {.bearing_i = {0.2, -0.1},
          .bearing_j = {0.1, -0.05},
          .seen_i = {0.19, -0.08},
          .seen_j = {0.11, -0.06},
          .lens = {0.01, -0.02, 0.003, -0.004},
          .velocity_i = {0.3, -0.2},
          .velocity_j = {0.25, 0.1},
          .exposure_i_s = 0.004,
          .exposure_j_s = -0.003,
          .inverse_depth_j = 0.53};
}
const ReprojectionNoise kNoise{.bearing = 0.003, .inverse_depth = 0.01, .depth_outlier = 2.0};

/// With the depth scale 1 and the lens of the measurement.
Blocks blocks_at(double time_offset) {
  return {block(kTwBi), block(kTwBj),   block(kTbC), {time_offset}, {0.01, -0.02, 0.003, -0.004},
          {1.0},        {kInverseDepth}};
}
Blocks without_depth_scale(Blocks blocks) {
  blocks.erase(blocks.begin() + 5);
  return blocks;
}

TEST(ReprojectionFactor, JacobiansMatchNumericDifferentiationWithoutDepth) {
  EXPECT_LT(
      jacobian_error(ReprojectionFactor<2>(measurement(), kNoise), without_depth_scale(blocks_at(0.002))),
      1e-6);
}

TEST(ReprojectionFactor, JacobiansMatchNumericDifferentiationWithDepth) {
  EXPECT_LT(jacobian_error(ReprojectionFactor<3>(measurement(), kNoise), blocks_at(0.002)), 1e-6);
}

TEST(ReprojectionFactor, JacobiansMatchNumericDifferentiationWithADepthScale) {
  Blocks blocks = blocks_at(0.002);
  blocks[5] = {0.9};
  const ReprojectionFactor<3> factor(measurement(), kNoise);
  EXPECT_LT(jacobian_error(factor, blocks), 1e-6);
  // By the depth scale to 1e-9: Richardson extrapolation of two step sizes.
  const Eigen::MatrixXd coarse = numeric_jacobians(factor, blocks, 2e-4)[5];
  const Eigen::MatrixXd numeric = (4.0 * numeric_jacobians(factor, blocks, 1e-4)[5] - coarse) / 3.0;
  EXPECT_LT((numeric - analytic_jacobians(factor, blocks)[5]).norm(), 1e-9 * numeric.norm());
}

TEST(ReprojectionFactor, IsSmoothAtInfinity) {
  for (const double inverse_depth : {0.0, -0.2}) {
    Blocks blocks = blocks_at(0.002);
    blocks.back() = {inverse_depth};
    EXPECT_LT(jacobian_error(ReprojectionFactor<3>(measurement(), kNoise), blocks), 1e-6) << inverse_depth;
  }
}

TEST(ReprojectionFactor, IsFiniteForAPointBehindTheCamera) {
  Blocks blocks = blocks_at(0.0);
  blocks.back() = {20.0};  // 5 cm in front of the host; j is 20 cm ahead
  const ReprojectionFactor<3> factor(measurement(), kNoise);
  double residual[3];
  EXPECT_TRUE(factor.Evaluate(addresses(blocks).data(), residual, nullptr));
  EXPECT_TRUE(Eigen::Vector3d(residual).allFinite());
  EXPECT_LT(jacobian_error(factor, blocks), 1e-6);
}

TEST(ReprojectionFactor, IsZeroAtTheTrueLandmark) {
  ReprojectionMeasurement m = measurement();
  m.velocity_i = m.velocity_j = Eigen::Vector2d::Zero();
  const Eigen::Vector3d p_ci = m.bearing_i.homogeneous() / kInverseDepth;
  const Eigen::Vector3d p_cj = (kTwBj * kTbC).inverse() * (kTwBi * kTbC * p_ci);
  m.bearing_j = p_cj.hnormalized();
  m.inverse_depth_j = 1.0 / p_cj.z();
  EXPECT_LT(residual_at(ReprojectionFactor<3>(m, kNoise), blocks_at(0.0)).norm(), 1e-9);
}

TEST(ReprojectionFactor, DepthRowIsBounded) {
  ReprojectionMeasurement m = measurement();
  m.inverse_depth_j = 100.0;  // 1 cm: an outlier
  const double depth_row = residual_at(ReprojectionFactor<3>(m, kNoise), blocks_at(0.0))[2];
  EXPECT_NEAR(std::abs(depth_row), kNoise.depth_outlier, 1e-3);  // d / sqrt(1 + (d/c)^2) tends to c
}

TEST(HostDepthFactor, JacobianMatchesNumericDifferentiation) {
  EXPECT_LT(jacobian_error(HostDepthFactor(0.51, kNoise), {{0.9}, {kInverseDepth}}), 1e-6);
}

}  // namespace
}  // namespace stillpoint
