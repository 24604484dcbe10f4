// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/covariance.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.h"
#include "core/geometry/pose_from_points.h"
#include "core/geometry/so3.h"

namespace stillpoint {

double largest_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, eigenvalues(covariance)[2]));
}

double chi_square_tail(double x, int degrees_of_freedom) {
  const double z = x / 2.0;
  const bool odd = degrees_of_freedom % 2 != 0;
  double a = odd ? 0.5 : 1.0;
  double tail = odd ? std::erfc(std::sqrt(z)) : std::exp(-z);
  double term = std::pow(z, a) * std::exp(-z) / std::tgamma(a + 1.0);
  for (; 2.0 * a < degrees_of_freedom; a += 1.0) {
    tail += term;
    term *= z / (a + 1.0);
  }
  return tail;
}

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

Vector6 pose_difference(const Pose& a, const Pose& b) {
  Vector6 d;
  d << b.p - a.p, log_so3(a.q.conjugate() * b.q);
  return d;
}

}  // namespace

UncertainPose in_frame(const UncertainPose& pose, const Pose& T_f_g) {
  return compose(pose, {.T_w_f = T_f_g});
}

UncertainPose compose(const UncertainPose& a, const UncertainPose& b) {
  Matrix6 J_a = Matrix6::Identity();
  J_a.topRightCorner<3, 3>() = -a.T_w_f.R() * skew(b.T_w_f.p);
  J_a.bottomRightCorner<3, 3>() = b.T_w_f.R().transpose();
  Matrix6 J_b = Matrix6::Identity();
  J_b.topLeftCorner<3, 3>() = a.T_w_f.R();
  return {.T_w_f = a.T_w_f * b.T_w_f,
          .covariance = propagate(J_a, a.covariance) + propagate(J_b, b.covariance)};
}

UncertainPose inverse(const UncertainPose& a) {
  const Eigen::Matrix3d R_transposed = a.T_w_f.R().transpose();
  Matrix6 J = Matrix6::Zero();
  J.topLeftCorner<3, 3>() = -R_transposed;
  J.topRightCorner<3, 3>() = -skew(R_transposed * a.T_w_f.p);
  J.bottomRightCorner<3, 3>() = -a.T_w_f.R();
  return {.T_w_f = a.T_w_f.inverse(), .covariance = propagate(J, a.covariance)};
}

UncertainPose relative_pose(const Pose& T_w_a, const Pose& T_w_b, const Matrix12& joint) {
  const Pose T_a_b = T_w_a.inverse() * T_w_b;
  const Eigen::Matrix3d R_a_w = T_w_a.R().transpose();
  Eigen::Matrix<double, 6, 12> J = Eigen::Matrix<double, 6, 12>::Zero();
  J.block<3, 3>(0, 0) = -R_a_w;
  J.block<3, 3>(0, 3) = skew(T_a_b.p);
  J.block<3, 3>(0, 6) = R_a_w;
  J.block<3, 3>(3, 3) = -T_a_b.R().transpose();
  J.block<3, 3>(3, 9).setIdentity();
  return {.T_w_f = T_a_b, .covariance = propagate(J, joint)};
}

Eigen::Matrix2d projection_covariance(const UncertainPose& camera, const Eigen::Vector3d& p_c) {
  const Eigen::Matrix<double, 2, 3> J_point = bearing_jacobian(p_c.hnormalized(), 1.0 / p_c.z());
  Eigen::Matrix<double, 2, 6> J;
  J << -J_point * camera.T_w_f.R().transpose(), J_point * skew(p_c);
  return propagate(J, camera.covariance);
}

double squared_distance(const Pose& a, const Pose& b, const Matrix6& covariance) {
  const Vector6 d = pose_difference(a, b);
  return d.dot(solve_symmetric(covariance, d));
}

UncertainPose fuse(const UncertainPose& a, const UncertainPose& b) {
  const Matrix6 sum = a.covariance + b.covariance;
  const Matrix6 K = solve_symmetric(sum, a.covariance).transpose();
  const Vector6 step = K * pose_difference(a.T_w_f, b.T_w_f);
  return {.T_w_f = {(a.T_w_f.q * exp_so3(step.tail<3>())).normalized(), a.T_w_f.p + step.head<3>()},
          .covariance = a.covariance - K * a.covariance};
}

}  // namespace stillpoint
