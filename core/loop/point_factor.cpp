// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/point_factor.h"

#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

constexpr double kMinPoint_z = 0.05;  // [m]

}  // namespace

PointFactor::PointFactor(const Eigen::Vector3d& p_c, const Pose& T_b_c, double bearing_sigma,
                         double inverse_depth_sigma)
    : measured_(p_c.x() / p_c.z(), p_c.y() / p_c.z(), 1.0 / p_c.z()),
      T_c_b_(T_b_c.inverse()),
      inverse_sigmas_(1.0 / bearing_sigma, 1.0 / bearing_sigma, 1.0 / inverse_depth_sigma) {}

bool PointFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Eigen::Matrix3d R_b_m = Eigen::Quaterniond(parameters[0] + 3).conjugate().toRotationMatrix();
  const Eigen::Vector3d X_b = R_b_m * (Eigen::Vector3d(parameters[1]) - Eigen::Vector3d(parameters[0]));
  const Eigen::Vector3d X_c = T_c_b_ * X_b;
  if (X_c.z() < kMinPoint_z) return false;
  const double inverse_z = 1.0 / X_c.z();
  const Eigen::Vector3d predicted(X_c.x() * inverse_z, X_c.y() * inverse_z, inverse_z);
  Eigen::Map<Eigen::Vector3d>{residuals} = inverse_sigmas_.cwiseProduct(predicted - measured_);
  if (jacobians == nullptr) return true;
  Eigen::Matrix3d projection;
  projection << inverse_z, 0.0, -predicted.x() * inverse_z, 0.0, inverse_z, -predicted.y() * inverse_z, 0.0,
      0.0, -inverse_z * inverse_z;
  const Eigen::Matrix3d dr_dX_b = inverse_sigmas_.asDiagonal() * projection * T_c_b_.R();
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> J(jacobians[0]);
    J << -dr_dX_b * R_b_m, dr_dX_b * skew(X_b), Eigen::Vector3d::Zero();
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{jacobians[1]} = dr_dX_b * R_b_m;
  }
  return true;
}

}  // namespace stillpoint
