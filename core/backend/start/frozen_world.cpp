// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/frozen_world.h"

#include <Eigen/LU>

#include "core/backend/factors/gravity_direction.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

/// Ratio of the covariance of gravity in the initial prior to that of the alignment, which used the same
/// samples.
constexpr double kReuseFactor = 100.0;

/// 0.999 quantile of the chi-square distribution with two degrees of freedom.
constexpr double kGravityGate = 13.8;

/// Covariance of the tangent vector of gravity. A change du of its direction u is the rotation u x du.
Eigen::Matrix2d tangent_covariance(const Eigen::Vector3d& gravity_w, const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix<double, 2, 3> J = gravity_basis(gravity_w).transpose() * skew(gravity_w.normalized());
  return J * covariance * J.transpose();
}

/// Whether a measured gravity contradicts the gravity of the window.
bool contradicts(const Eigen::Vector3d& measured, const Eigen::Matrix2d& covariance, const Window& window) {
  const Eigen::Vector2d difference = gravity_difference(measured, window.gravity_w);
  const Eigen::Matrix2d sum = covariance + *window.gravity_covariance;
  return !(difference.dot(sum.inverse() * difference) <= kGravityGate);
}

/// Rotates all states about the position of frame 0 such that it has the attitude of `anchor`.
/// @return the rotation
Eigen::Quaterniond restore_attitude(const Pose& anchor, Window& window) {
  const Pose first = window.frames[0].state.T_w_b;
  const Eigen::Quaterniond q_new_old = (anchor.q * first.q.conjugate()).normalized();
  const Pose T_new_old{q_new_old, first.p - q_new_old * first.p};
  for (WindowFrame& frame : window.frames) {
    frame.state.T_w_b = T_new_old * frame.state.T_w_b;
    frame.state.v_w = q_new_old * frame.state.v_w;
  }
  return q_new_old;
}

}  // namespace

Eigen::Matrix<double, 3, 2> orthogonal_vectors(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d first = direction.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> vectors;
  vectors << first, direction.normalized().cross(first);
  return vectors;
}

Eigen::MatrixXd least_squares_covariance(const Eigen::MatrixXd& A) { return (A.transpose() * A).inverse(); }

Eigen::Matrix3d gravity_direction_covariance(const AlignmentEquations& equations,
                                             const Eigen::Vector3d& gravity_w, double accel_bias_sigma) {
  const double norm = gravity_w.norm();
  const Eigen::Matrix<double, 3, 2> basis = orthogonal_vectors(gravity_w);
  const Eigen::Index scale_columns = equations.A.cols() - 6;
  Eigen::MatrixXd A(equations.A.rows(), 5 + scale_columns);
  A << equations.A.leftCols<3>(), norm * equations.A.middleCols<3>(3) * basis,
      equations.A.rightCols(scale_columns);
  const Eigen::VectorXd y = equations.y - equations.A.middleCols<3>(3) * gravity_w;
  const Eigen::MatrixXd covariance = least_squares_covariance(A);
  const double variance =
      (y - A * (covariance * (A.transpose() * y))).squaredNorm() / static_cast<double>(A.rows() - A.cols());
  const double bias_variance = accel_bias_sigma * accel_bias_sigma / (norm * norm);
  return basis * (variance * covariance.block<2, 2>(3, 3) + bias_variance * Eigen::Matrix2d::Identity()) *
         basis.transpose();
}

void apply_alignment_to_frozen_world(const InertialAlignment& alignment, const Pose& anchor, Window& window) {
  const Eigen::Vector3d known_gravity_w = window.gravity_w;
  const bool known = window.gravity_covariance.has_value();
  // Gravity and its covariance move with the poses.
  const Eigen::Quaterniond q_w_v = window.frames[0].state.T_w_b.q;
  apply_alignment(alignment, anchor, window);
  Eigen::Quaterniond q_new_old = window.frames[0].state.T_w_b.q * q_w_v.conjugate();
  if (known) {
    const Eigen::Quaterniond q_restored = restore_attitude(anchor, window);
    q_new_old = q_restored * q_new_old;
    window.gravity_w = q_restored * window.gravity_w;
  }
  const Eigen::Matrix3d R = q_new_old.toRotationMatrix();
  const Eigen::Matrix2d covariance =
      tangent_covariance(window.gravity_w, R * alignment.gravity_covariance * R.transpose());
  const Eigen::Vector3d aligned = window.gravity_w;
  if (known) window.gravity_w = known_gravity_w;
  if (known && !contradicts(aligned, covariance, window)) return;
  window.gravity_w = aligned;
  window.gravity_covariance = kReuseFactor * covariance;
}

}  // namespace stillpoint
