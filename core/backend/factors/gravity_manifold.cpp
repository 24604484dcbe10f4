// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/factors/gravity_manifold.h"

#include "core/backend/factors/gravity_direction.h"

namespace stillpoint {

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
