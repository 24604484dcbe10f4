// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/so3.h"

#include <gtest/gtest.h>

namespace stillpoint {
namespace {

const Eigen::Vector3d kTheta(0.3, -0.7, 1.1);

TEST(So3, LogarithmInvertsTheExponential) {
  EXPECT_LT((log_so3(exp_so3(kTheta)) - kTheta).norm(), 1e-14);
  EXPECT_LT((log_so3(exp_so3(1e-7 * kTheta)) - 1e-7 * kTheta).norm(), 1e-20);
}

TEST(So3, LogarithmReturnsTheShorterRotation) {
  Eigen::Quaterniond q = exp_so3(kTheta);
  q.coeffs() *= -1.0;  // the same rotation
  EXPECT_LT((log_so3(q) - kTheta).norm(), 1e-14);
}

TEST(So3, RightJacobianMatchesAFiniteDifference) {
  const Eigen::Vector3d change(1e-6, -2e-6, 3e-6);
  const Eigen::Vector3d measured = log_so3(exp_so3(kTheta).conjugate() * exp_so3(kTheta + change));
  EXPECT_LT((measured - right_jacobian(kTheta) * change).norm(), 1e-11);  // second order: |change|^2
}

TEST(So3, InverseJacobianInvertsTheJacobianAtAllAngles) {
  for (const double scale : {1e-9, 1e-6, 1e-3, 1.0, 2.0}) {
    const Eigen::Matrix3d product = right_jacobian(scale * kTheta) * right_jacobian_inverse(scale * kTheta);
    EXPECT_LT((product - Eigen::Matrix3d::Identity()).norm(), 1e-9) << "scale " << scale;
  }
}

}  // namespace
}  // namespace stillpoint
