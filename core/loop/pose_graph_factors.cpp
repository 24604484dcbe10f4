// SPDX-License-Identifier: BSD-3-Clause
#include "core/loop/pose_graph_factors.h"

#include <cmath>

#include "core/backend/factors/gravity_direction.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/pose_from_points.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

using PoseJacobian = Eigen::Matrix<double, 6, 7, Eigen::RowMajor>;

Pose pose_at(const double* x) { return {Eigen::Quaterniond(x + 3), Eigen::Vector3d(x)}; }

}  // namespace

RelativePoseFactor::RelativePoseFactor(const GraphEdge& edge, const double& weight)
    : T_i_j_(edge.T_i_j), sqrt_information_(inverse_root(edge.covariance)), weight_(weight) {}

bool RelativePoseFactor::Evaluate(double const* const* parameters, double* residuals,
                                  double** jacobians) const {
  const Pose T_m_i = pose_at(parameters[0]);
  const Pose T_m_j = pose_at(parameters[1]);
  const Eigen::Matrix3d R_i_m = T_m_i.R().transpose();
  const Eigen::Vector3d v = R_i_m * (T_m_j.p - T_m_i.p);
  const Eigen::Vector3d e = log_so3(T_i_j_.q.conjugate() * T_m_i.q.conjugate() * T_m_j.q);
  Eigen::Map<Eigen::Matrix<double, 6, 1>> r(residuals);
  r << v - T_i_j_.p, e;
  const Matrix6 scale = std::sqrt(weight_) * sqrt_information_;
  r = scale * r;
  if (jacobians == nullptr) return true;
  const Eigen::Matrix3d Jr_inverse = right_jacobian_inverse(e);
  if (jacobians[0] != nullptr) {
    Matrix6 J = Matrix6::Zero();
    J.topLeftCorner<3, 3>() = -R_i_m;
    J.topRightCorner<3, 3>() = skew(v);
    J.bottomRightCorner<3, 3>() = -Jr_inverse * (T_m_j.R().transpose() * T_m_i.R());
    Eigen::Map<PoseJacobian> J_i(jacobians[0]);
    J_i << scale * J, Eigen::Matrix<double, 6, 1>::Zero();
  }
  if (jacobians[1] != nullptr) {
    Matrix6 J = Matrix6::Zero();
    J.topLeftCorner<3, 3>() = R_i_m;
    J.bottomRightCorner<3, 3>() = Jr_inverse;
    Eigen::Map<PoseJacobian> J_j(jacobians[1]);
    J_j << scale * J, Eigen::Matrix<double, 6, 1>::Zero();
  }
  return true;
}

bool GravityFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Eigen::Matrix3d R_b_m = pose_at(parameters[0]).R().transpose();
  const Eigen::Vector3d g(parameters[1]);
  const Eigen::Vector3d g_b = R_b_m * g;
  Eigen::Map<Eigen::Vector3d>{residuals} = (g_b - gravity_b_) / sigma_;
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> J(jacobians[0]);
    J.setZero();
    J.block<3, 3>(0, 3) = skew(g_b) / sigma_;
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> J(jacobians[1]);
    J.setZero();
    J.leftCols<2>() = R_b_m * gravity_jacobian(g) / sigma_;
  }
  return true;
}

bool HeadingManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Pose pose = pose_at(x);
  Eigen::Map<Eigen::Vector3d>{x_plus_delta} = pose.p + Eigen::Map<const Eigen::Vector3d>(delta);
  Eigen::Map<Eigen::Quaterniond>{x_plus_delta + 3} = (exp_so3(up_ * delta[3]) * pose.q).normalized();
  return true;
}

/// In the columns of the factors: d theta = R^T n d psi.
bool HeadingManifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 7, 4, Eigen::RowMajor>> J(jacobian);
  J.setZero();
  J.topLeftCorner<3, 3>().setIdentity();
  J.block<3, 1>(3, 3) = pose_at(x).q.conjugate() * up_;
  return true;
}

bool HeadingManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  const Pose before = pose_at(x);
  const Pose after = pose_at(y);
  Eigen::Map<Eigen::Vector3d>{y_minus_x} = after.p - before.p;
  y_minus_x[3] = up_.dot(log_so3(after.q * before.q.conjugate()));
  return true;
}

bool HeadingManifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 4, 7, Eigen::RowMajor>> J(jacobian);
  J.setZero();
  J.topLeftCorner<3, 3>().setIdentity();
  J.block<1, 3>(3, 3) = (pose_at(x).q.conjugate() * up_).transpose();
  return true;
}

namespace {

constexpr double kMinLandmarkDepth_m = 0.05;  // [m]

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
  if (X_c.z() < kMinLandmarkDepth_m) return false;
  const double inverse_z = 1.0 / X_c.z();
  const Eigen::Vector3d predicted(X_c.x() * inverse_z, X_c.y() * inverse_z, inverse_z);
  Eigen::Map<Eigen::Vector3d>{residuals} = inverse_sigmas_.cwiseProduct(predicted - measured_);
  if (jacobians == nullptr) return true;
  const Eigen::Matrix3d dr_dX_b =
      inverse_sigmas_.asDiagonal() * inverse_depth_jacobian(predicted.head<2>(), inverse_z) * T_c_b_.R();
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
