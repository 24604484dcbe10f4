// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/ceres_manifolds.h"

#include <Eigen/Geometry>

#include "core/backend/factors/gravity_direction.h"
#include "core/geometry/so3.h"

namespace stillpoint {

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  Eigen::Map<Eigen::Vector3d>{x_plus_delta} =
      Eigen::Map<const Eigen::Vector3d>(x) + Eigen::Map<const Eigen::Vector3d>(delta);
  const Eigen::Quaterniond q(x + 3);
  Eigen::Map<Eigen::Quaterniond>{x_plus_delta + 3} =
      (q * exp_so3(Eigen::Map<const Eigen::Vector3d>(delta + 3))).normalized();
  return true;
}

bool PoseManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>{jacobian}.setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Eigen::Vector3d>{y_minus_x} =
      Eigen::Map<const Eigen::Vector3d>(y) - Eigen::Map<const Eigen::Vector3d>(x);
  Eigen::Map<Eigen::Vector3d>{y_minus_x + 3} =
      log_so3(Eigen::Quaterniond(x + 3).conjugate() * Eigen::Quaterniond(y + 3));
  return true;
}

bool PoseManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>{jacobian}.setIdentity();
  return true;
}

bool GravityManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  Eigen::Map<Eigen::Vector3d>{x_plus_delta} = rotate_gravity(Eigen::Vector3d(x), Eigen::Vector2d(delta));
  return true;
}

bool GravityManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 3, 2, Eigen::RowMajor>>{jacobian}.setIdentity();
  return true;
}

bool GravityManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Eigen::Vector2d>{y_minus_x} = gravity_difference(Eigen::Vector3d(y), Eigen::Vector3d(x));
  return true;
}

bool GravityManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>{jacobian}.setIdentity();
  return true;
}

}  // namespace stillpoint
