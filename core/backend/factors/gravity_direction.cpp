// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/gravity_direction.h"

#include <cmath>

#include "core/geometry/so3.h"

namespace stillpoint {

Eigen::Matrix<double, 3, 2> gravity_basis(const Eigen::Vector3d& gravity) {
  const Eigen::Vector3d n = -gravity.normalized();
  const double scale = 1.0 / (1.0 + n.z());
  Eigen::Matrix<double, 3, 2> basis;
  basis << 1.0 - n.x() * n.x() * scale, -n.x() * n.y() * scale,  //
      -n.x() * n.y() * scale, 1.0 - n.y() * n.y() * scale,       //
      -n.x(), -n.y();
  return basis;
}

Eigen::Vector3d rotate_gravity(const Eigen::Vector3d& gravity, const Eigen::Vector2d& d) {
  const Eigen::Vector3d rotated = exp_so3(gravity_basis(gravity) * d) * gravity;
  return rotated * (gravity.norm() / rotated.norm());  // no drift of the norm by rounding
}

Eigen::Vector2d gravity_difference(const Eigen::Vector3d& gravity, const Eigen::Vector3d& origin) {
  const Eigen::Vector3d axis = origin.cross(gravity);
  const double sine = axis.norm();
  const double cosine = origin.dot(gravity);
  const double per_sine = sine > 0.0 ? std::atan2(sine, cosine) / sine : 1.0 / cosine;
  return gravity_basis(origin).transpose() * (per_sine * axis);
}

Eigen::Matrix<double, 3, 2> gravity_jacobian(const Eigen::Vector3d& gravity) {
  return -skew(gravity) * gravity_basis(gravity);
}

Eigen::Quaterniond level_rotation(const Eigen::Vector3d& gravity) {
  // Not Eigen's FromTwoVectors, which compiles a singular value decomposition for opposite vectors.
  constexpr double kOpposite = 1e-12 - 1.0;
  const Eigen::Vector3d from = gravity.normalized();
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  const double cosine = down.dot(from);
  if (cosine < kOpposite) return {0.0, 1.0, 0.0, 0.0};
  const double scale = std::sqrt((1.0 + cosine) * 2.0);  // twice the cosine of half the angle
  Eigen::Quaterniond q;
  q.vec() = from.cross(down) * (1.0 / scale);
  q.w() = scale * 0.5;
  return q;
}

}  // namespace stillpoint
