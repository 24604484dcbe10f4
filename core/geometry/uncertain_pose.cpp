// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/uncertain_pose.h"

#include <Eigen/Cholesky>

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

using Matrix6 = UncertainPose::Matrix6;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Vector6 pose_difference(const Pose& a, const Pose& b) {
  Vector6 d;
  d << b.p - a.p, log_so3(a.q.conjugate() * b.q);
  return d;
}

}  // namespace

UncertainPose in_frame(const UncertainPose& pose, const Pose& T_f_g) {
  Matrix6 J = Matrix6::Identity();
  J.topRightCorner<3, 3>() = -pose.T_w_f.R() * skew(T_f_g.p);
  J.bottomRightCorner<3, 3>() = T_f_g.R().transpose();
  return {pose.T_w_f * T_f_g, J * pose.covariance * J.transpose()};
}

double squared_distance(const Pose& a, const Pose& b, const Matrix6& covariance) {
  const Vector6 d = pose_difference(a, b);
  return d.dot(covariance.ldlt().solve(d));
}

UncertainPose fuse(const UncertainPose& a, const UncertainPose& b) {
  const Matrix6 sum = a.covariance + b.covariance;
  const Matrix6 K = sum.ldlt().solve(a.covariance).transpose();
  const Vector6 step = K * pose_difference(a.T_w_f, b.T_w_f);
  return {.T_w_f = {(a.T_w_f.q * exp_so3(step.tail<3>())).normalized(), a.T_w_f.p + step.head<3>()},
          .covariance = a.covariance - K * a.covariance};
}

}  // namespace stillpoint
