// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/uncertain_pose.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = UncertainPose::Matrix6;

Pose perturbed(const Pose& pose, const Vector6& error) {
  return {pose.q * exp_so3(error.tail<3>()), pose.p + error.head<3>()};
}

const Pose kPose{exp_so3({0.3, -0.5, 0.8}), {1.0, 2.0, 3.0}};

TEST(UncertainPose, MovesTheErrorToAnotherFrameOfTheBody) {
  const Pose T_f_g{exp_so3({-0.2, 0.4, 0.1}), {0.5, -0.3, 0.2}};
  Vector6 error;
  error << 0.01, -0.02, 0.03, 0.002, 0.001, -0.003;
  const UncertainPose moved = in_frame({kPose, error * error.transpose()}, T_f_g);
  // The covariance of a single error is its outer product, also in the other frame.
  const Pose moved_error = perturbed(kPose, error) * T_f_g;
  Vector6 expected;
  expected << moved_error.p - moved.T_w_f.p, log_so3(moved.T_w_f.q.conjugate() * moved_error.q);
  EXPECT_TRUE(moved.covariance.isApprox(expected * expected.transpose(), 1e-2));
}

TEST(UncertainPose, MeasuresDistancesInStandardDeviations) {
  Vector6 sigmas;
  sigmas << 0.1, 0.2, 0.3, 0.01, 0.02, 0.03;
  const Matrix6 covariance = sigmas.cwiseAbs2().asDiagonal();
  // Two standard deviations in y and one about z: 4 + 1.
  Vector6 error = Vector6::Zero();
  error[1] = 0.4;
  error[5] = 0.03;
  EXPECT_NEAR(squared_distance(kPose, perturbed(kPose, error), covariance), 5.0, 1e-9);
}

TEST(UncertainPose, FusesTwoEstimatesByTheirInformation) {
  Vector6 a, b, error;
  a << 0.3, 0.1, 0.1, 0.01, 0.01, 0.01;
  b << 0.1, 0.1, 0.1, 0.03, 0.01, 0.01;
  error << 0.1, 0.0, 0.0, 0.02, 0.0, 0.0;
  const Pose other = perturbed(kPose, error);
  const UncertainPose fused = fuse({kPose, a.cwiseAbs2().asDiagonal()}, {other, b.cwiseAbs2().asDiagonal()});
  // Weights of the second one: 0.09 / (0.09 + 0.01) in x, 0.0001 / (0.0001 + 0.0009) about x.
  EXPECT_NEAR((fused.T_w_f.p - kPose.p).x(), 0.09, 1e-9);
  EXPECT_NEAR(log_so3(kPose.q.conjugate() * fused.T_w_f.q).x(), 0.002, 1e-9);
  EXPECT_NEAR(fused.covariance(0, 0), 0.009, 1e-9);    // 1 / (1 / 0.09 + 1 / 0.01)
  EXPECT_NEAR(fused.covariance(3, 3), 0.00009, 1e-9);  // 1 / (1 / 0.0001 + 1 / 0.0009)
}

}  // namespace
}  // namespace stillpoint
