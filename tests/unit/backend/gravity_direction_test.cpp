// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/gravity_direction.h"

#include <gtest/gtest.h>

#include "core/backend/factors/linear_prior.h"

namespace stillpoint {
namespace {

const Eigen::Vector3d kTilted = 9.81 * Eigen::Vector3d(0.2, -0.35, -1.0).normalized();

TEST(GravityDirection, TheBasisIsOrthonormalAndTangent) {
  for (const Eigen::Vector3d& g :
       {kTilted, Eigen::Vector3d(0.0, 0.0, -9.81), Eigen::Vector3d(9.0, 1.0, 3.0)}) {
    const Eigen::Matrix<double, 3, 2> basis = gravity_basis(g);
    EXPECT_LT((basis.transpose() * basis - Eigen::Matrix2d::Identity()).norm(), 1e-14);
    EXPECT_LT((basis.transpose() * g).norm(), 1e-13);
  }
}

TEST(GravityDirection, TheDifferenceInvertsTheRotationAndTheNormIsConstant) {
  for (const Eigen::Vector2d& d :
       {Eigen::Vector2d(0.4, -0.7), Eigen::Vector2d(1e-9, 2e-9), Eigen::Vector2d(0.0, 0.0)}) {
    const Eigen::Vector3d moved = rotate_gravity(kTilted, d);
    EXPECT_NEAR(moved.norm(), 9.81, 1e-13);
    EXPECT_LT((gravity_difference(moved, kTilted) - d).norm(), 1e-14 + 1e-12 * d.norm());
  }
}

TEST(GravityDirection, TheJacobianMatchesNumericDifferentiation) {
  constexpr double h = 1e-5;
  Eigen::Matrix<double, 3, 2> numeric;
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector2d step = h * Eigen::Vector2d::Unit(k);
    numeric.col(k) = (rotate_gravity(kTilted, step) - rotate_gravity(kTilted, -step)) / (2.0 * h);
  }
  EXPECT_LT((numeric - gravity_jacobian(kTilted)).norm(), 1e-9 * numeric.norm());
}

TEST(GravityDirection, TheLevelRotationTakesGravityToMinusZByTheSmallestAngle) {
  for (const Eigen::Vector3d& gravity :
       {kTilted, Eigen::Vector3d(0.0, 0.0, -9.81), Eigen::Vector3d(3.0, -2.0, 8.0)}) {
    const Eigen::Quaterniond q = level_rotation(gravity);
    EXPECT_NEAR(q.norm(), 1.0, 1e-14);
    EXPECT_LT((q * gravity - Eigen::Vector3d(0.0, 0.0, -gravity.norm())).norm(), 1e-13);
    EXPECT_EQ(q.z(), 0.0);  // the axis is horizontal
  }
}

TEST(GravityDirection, GravityAlongZIsLeveledByHalfATurn) {
  const Eigen::Vector3d leveled = level_rotation({0.0, 0.0, 9.81}) * Eigen::Vector3d(0.0, 0.0, 9.81);
  EXPECT_LT((leveled - Eigen::Vector3d(0.0, 0.0, -9.81)).norm(), 1e-14);
}

TEST(GravityDirection, ThePriorYieldsTheCovarianceOfGravity) {
  LinearPrior prior;
  prior.blocks = {{BlockKind::kSpeedBias, 0, Eigen::VectorXd::Zero(9)}, {BlockKind::kGravity, -1, kTilted}};
  prior.jacobian = Eigen::MatrixXd::Identity(11, 11);
  prior.jacobian(9, 9) = 50.0;
  prior.jacobian(10, 10) = 20.0;
  prior.jacobian(10, 8) = 1.0;  // gravity is known relative to a bias of unit variance
  prior.residual = Eigen::VectorXd::Zero(11);
  const std::optional<Eigen::Matrix2d> covariance = gravity_covariance(prior);
  ASSERT_TRUE(covariance);
  EXPECT_NEAR((*covariance)(0, 0), 1.0 / 2500.0, 1e-15);
  EXPECT_NEAR((*covariance)(1, 1), 2.0 / 400.0, 1e-14);
  prior.blocks.pop_back();
  EXPECT_FALSE(gravity_covariance(prior));
}

}  // namespace
}  // namespace stillpoint
