// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/covariance.h"

#include <gtest/gtest.h>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

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

TEST(UncertainPose, ProjectsItsErrorToThePositionsOfPoints) {
  const Eigen::Vector3d p_c(0.6, -0.4, 2.0);
  const Eigen::Vector3d p_w = kPose * p_c;
  for (int axis = 0; axis < 6; ++axis) {
    const Vector6 error = 1e-4 * Vector6::Unit(axis);
    const Eigen::Vector2d moved = (perturbed(kPose, error).inverse() * p_w).hnormalized() - p_c.hnormalized();
    const Eigen::Matrix2d projected = projection_covariance({kPose, error * error.transpose()}, p_c);
    EXPECT_TRUE(projected.isApprox(moved * moved.transpose(), 1e-3)) << axis;
  }
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

const Pose kFirst{exp_so3({0.3, -0.2, 1.1}), {1.0, -2.0, 0.5}};
const Pose kSecond{exp_so3({0.1, 0.4, 1.9}), {2.0, -1.0, 0.7}};
constexpr double kStep = 1e-6;

/// The pose with the error `step` along axis 0 to 5 of (rho, theta).
Pose moved(const Pose& pose, int axis, double step) {
  Eigen::Matrix<double, 6, 1> error = Eigen::Matrix<double, 6, 1>::Zero();
  error[axis] = step;
  return {(pose.q * exp_so3(error.tail<3>())).normalized(), pose.p + error.head<3>()};
}

/// Derivative of the error (rho, theta) of a pose, by its values at +-kStep.
Eigen::Matrix<double, 6, 1> derivative(const Pose& plus, const Pose& minus) {
  Eigen::Matrix<double, 6, 1> result;
  result << plus.p - minus.p, log_so3(minus.q.conjugate() * plus.q);
  return result / (2.0 * kStep);
}

/// Symmetric, positive definite, without zeros.
template <int Size>
Eigen::Matrix<double, Size, Size> dense_covariance() {
  Eigen::Matrix<double, Size, Size> root;
  for (int i = 0; i < Size * Size; ++i) root(i / Size, i % Size) = std::sin(1.0 + 3.0 * i);
  return root * root.transpose() + Eigen::Matrix<double, Size, Size>::Identity();
}

TEST(UncertainPose, TheCovarianceOfACompositionFollowsFromItsDerivatives) {
  const Matrix12 joint = dense_covariance<12>();
  const UncertainPose a{kFirst, joint.topLeftCorner<6, 6>()};
  const UncertainPose b{kSecond, joint.bottomRightCorner<6, 6>()};
  Matrix6 J_a, J_b;
  for (int i = 0; i < 6; ++i) {
    J_a.col(i) = derivative(moved(kFirst, i, kStep) * kSecond, moved(kFirst, i, -kStep) * kSecond);
    J_b.col(i) = derivative(kFirst * moved(kSecond, i, kStep), kFirst * moved(kSecond, i, -kStep));
  }
  const Matrix6 expected = J_a * a.covariance * J_a.transpose() + J_b * b.covariance * J_b.transpose();
  EXPECT_TRUE(compose(a, b).covariance.isApprox(expected, 1e-8));
}

TEST(UncertainPose, TheInverseOfTheInverseIsThePose) {
  const UncertainPose a{kFirst, dense_covariance<6>()};
  EXPECT_TRUE(inverse(inverse(a)).covariance.isApprox(a.covariance, 1e-12));
  const UncertainPose b{kSecond, dense_covariance<6>()};
  // (A B)^-1 = B^-1 A^-1
  EXPECT_TRUE(inverse(compose(a, b)).covariance.isApprox(compose(inverse(b), inverse(a)).covariance, 1e-12));
}

TEST(UncertainPose, TheCovarianceOfARelativePoseFollowsFromItsDerivatives) {
  const Matrix12 joint = dense_covariance<12>();
  Eigen::Matrix<double, 6, 12> J;
  for (int i = 0; i < 6; ++i) {
    J.col(i) =
        derivative(moved(kFirst, i, kStep).inverse() * kSecond, moved(kFirst, i, -kStep).inverse() * kSecond);
    J.col(6 + i) =
        derivative(kFirst.inverse() * moved(kSecond, i, kStep), kFirst.inverse() * moved(kSecond, i, -kStep));
  }
  const UncertainPose relative = relative_pose(kFirst, kSecond, joint);
  EXPECT_TRUE(relative.covariance.isApprox(J * joint * J.transpose(), 1e-8));
  EXPECT_LT((relative.T_w_f.p - (kFirst.inverse() * kSecond).p).norm(), 1e-15);
}

TEST(UncertainPose, ADisplacementOfBothPosesLeavesTheRelativePoseCertain) {
  Matrix12 joint = Matrix12::Zero();  // rho_a = rho_b
  joint.block<3, 3>(0, 0) = joint.block<3, 3>(0, 6) = joint.block<3, 3>(6, 0) = joint.block<3, 3>(6, 6) =
      Eigen::Matrix3d::Identity();
  EXPECT_TRUE(relative_pose(kFirst, kSecond, joint).covariance.isZero(1e-12));
}

}  // namespace
}  // namespace stillpoint
