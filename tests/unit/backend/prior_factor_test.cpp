// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/reference/state_factors.h"

#include <array>
#include <utility>

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/numeric_jacobian.h"

namespace stillpoint {
namespace {

LinearPrior pose_and_offset_prior() {
  LinearPrior prior;
  Eigen::VectorXd pose(7);
  pose << 1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0;
  prior.blocks = {{BlockKind::kPose, 0, pose},
                  {BlockKind::kTimeOffset, -1, Eigen::VectorXd::Constant(1, 0.01)}};
  prior.jacobian = Eigen::MatrixXd::Random(5, 7);
  prior.residual = Eigen::VectorXd::LinSpaced(5, -1.0, 1.0);
  return prior;
}

TEST(PriorFactor, JacobiansMatchNumericDifferentiationAtTheLinearizationPoint) {
  const LinearPrior prior = pose_and_offset_prior();
  EXPECT_LT(jacobian_error(PriorFactor(prior), {{1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0}, {0.01}}), 1e-8);
}

TEST(PriorFactor, ReturnsR0AtTheLinearizationPoint) {
  const LinearPrior prior = pose_and_offset_prior();
  const Eigen::VectorXd residual =
      residual_at(PriorFactor(prior), {{1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0}, {0.01}});
  EXPECT_LT((residual - prior.residual).norm(), 1e-14);
}

TEST(LinearPrior, TheDifferenceOfADisplacedBlockIsItsDisplacement) {
  Eigen::VectorXd pose(7);
  pose << 1.0, 2.0, 3.0, 0.5, 0.5, -0.5, 0.5;
  const std::array<std::pair<BlockKind, Eigen::VectorXd>, 4> blocks = {
      {{BlockKind::kPose, pose},
       {BlockKind::kSpeedBias, Eigen::VectorXd::LinSpaced(9, -1.0, 1.0)},
       {BlockKind::kGravity, Eigen::Vector3d(0.3, -0.2, -9.8)},
       {BlockKind::kLens, Eigen::Vector4d(0.01, 0.05, 0.0, 0.002)}}};
  for (const auto& [kind, origin] : blocks) {
    const Eigen::VectorXd d = Eigen::VectorXd::LinSpaced(local_size(kind), -0.02, 0.03);
    Eigen::VectorXd x = origin;
    displace_block(kind, d.data(), x.data());
    EXPECT_LT((block_difference(kind, x.data(), origin) - d).norm(), 1e-14) << global_size(kind);
  }
}

TEST(LinearPrior, ARandomStepAddsItsVariance) {
  LinearPrior prior = pose_and_offset_prior();
  prior.jacobian = Eigen::MatrixXd::Random(7, 7) + 3.0 * Eigen::MatrixXd::Identity(7, 7);
  prior.residual = Eigen::VectorXd::LinSpaced(7, -1.0, 1.0);
  const Eigen::MatrixXd before = (prior.jacobian.transpose() * prior.jacobian).inverse();
  const Eigen::VectorXd minimum = prior.jacobian.fullPivLu().solve(prior.residual);
  add_random_step(BlockKind::kTimeOffset, std::array{0.7}, prior);
  Eigen::MatrixXd expected = before;
  expected(6, 6) += 0.7 * 0.7;
  const Eigen::MatrixXd after = (prior.jacobian.transpose() * prior.jacobian).inverse();
  EXPECT_LT((after - expected).norm(), 1e-9 * expected.norm());
  EXPECT_LT((prior.jacobian.fullPivLu().solve(prior.residual) - minimum).norm(), 1e-9);
}

TEST(LinearPrior, ARandomStepOfAnAbsentBlockChangesNothing) {
  LinearPrior prior = pose_and_offset_prior();
  const Eigen::MatrixXd before = prior.jacobian;
  add_random_step(BlockKind::kDepthScale, std::array{0.3}, prior);
  EXPECT_EQ(Eigen::MatrixXd(prior.jacobian), before);
}

}  // namespace
}  // namespace stillpoint
