// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/prior_factor.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace stillpoint
