// SPDX-License-Identifier: BSD-3-Clause
// Not in the header: to instantiate these functions of Eigen takes 0.3 s of compiling in each group of
// sources.
#include "core/geometry/pose.h"

namespace stillpoint {

Pose Pose::inverse() const {
  const Eigen::Quaterniond conjugate = q.conjugate();
  return Pose{conjugate, -(conjugate * p)};
}

Pose Pose::from_matrix(const Eigen::Matrix4d& matrix) {
  return Pose{Eigen::Quaterniond(Eigen::Matrix3d(matrix.topLeftCorner<3, 3>())).normalized(),
              matrix.topRightCorner<3, 1>()};
}

Eigen::Matrix4d Pose::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = R();
  m.topRightCorner<3, 1>() = p;
  return m;
}

Pose operator*(const Pose& T_a_b, const Pose& T_b_c) {
  return Pose{(T_a_b.q * T_b_c.q).normalized(), T_a_b.q * T_b_c.p + T_a_b.p};
}

Pose interpolate(const Pose& a, const Pose& b, double s) {
  return Pose{a.q.slerp(s, b.q), (1.0 - s) * a.p + s * b.p};
}

}  // namespace stillpoint
