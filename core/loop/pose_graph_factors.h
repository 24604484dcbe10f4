// SPDX-License-Identifier: BSD-3-Clause
/// Residuals of the pose graph and of the bundle adjustment of its keyframes. Poses are blocks (p, q xyzw);
/// Jacobians are in the tangent space p + d, q * Exp(theta), in the first six of seven columns, see
/// core/backend/factors/ceres_manifolds.h.
#pragma once

#include <array>

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include "core/geometry/pose.h"
#include "core/loop/pose_graph.h"

namespace stillpoint {

using PoseBlock = std::array<double, 7>;

inline PoseBlock block_of(const Pose& pose) {
  return {pose.p.x(), pose.p.y(), pose.p.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w()};
}

inline Pose pose_of(const PoseBlock& block) {
  return {Eigen::Quaterniond(block.data() + 3).normalized(), Eigen::Vector3d(block.data())};
}

/// Relative pose of two keyframes (Carlone et al. 2015, Eq. (5), with the full covariance):
///
///   r = sqrt(w) L^T [ R_i^T (p_j - p_i) - p_ij ;  Log(q_ij^-1 q_i^-1 q_j) ],   L L^T = Sigma^-1
///
/// Jacobians of the bracket, with v = R_i^T (p_j - p_i) and e = Log(...):
///
///   d/dp_i = [-R_i^T; 0]    d/dtheta_i = [ [v]x; -Jr^-1(e) R_j^T R_i ]
///   d/dp_j = [ R_i^T; 0]    d/dtheta_j = [ 0; Jr^-1(e) ]
class RelativePoseFactor final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  /// @param edge its covariance must be positive definite
  /// @param weight w >= 0 of the robust estimation, read at each evaluation; must outlive the factor
  RelativePoseFactor(const GraphEdge& edge, const double& weight);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Pose T_i_j_;
  Matrix6 sqrt_information_;  ///< L^T
  const double& weight_;
};

/// Direction of gravity in the body, which an IMU measures without drift. g: unit vector of gravity in the
/// map, a variable of the graph, see core/backend/factors/gravity_direction.h; u: the measured one.
///
///   r = (R_i^T g - u) / sigma,   dr/dtheta_i = [R_i^T g]x / sigma,   dr/dg = -R_i^T [g]x B(g) / sigma
class GravityFactor final : public ceres::SizedCostFunction<3, 7, 3> {
 public:
  /// @param gravity_b unit vector
  /// @param sigma_rad > 0
  GravityFactor(const Eigen::Vector3d& gravity_b, double sigma_rad)
      : gravity_b_(gravity_b), sigma_(sigma_rad) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector3d gravity_b_;
  double sigma_;
};

/// Poses that move and turn about the vertical only (the four degrees of freedom of Qin et al. 2018, Sec.
/// VII):
///
///   p + d,   q <- Exp(n psi) q = q Exp(R^T n psi),   n = -g / |g|
class HeadingManifold final : public ceres::Manifold {
 public:
  /// @param gravity_m unit vector
  explicit HeadingManifold(const Eigen::Vector3d& gravity_m) : up_(-gravity_m) {}

  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 4; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  Eigen::Vector3d up_;
};

/// Landmark with measured depth in a keyframe. X: landmark in the map; p_c: measured position in the camera
/// frame; pi(X) = (x, y) / z:
///
///   X_b = R_m_b^T (X - p_m_b),   X_c = T_b_c^-1 X_b
///   r = [ (pi(X_c) - pi(p_c)) / s_b ;  (1 / z(X_c) - 1 / z(p_c)) / s_d ]
///
///   dX_b/dp = -R_m_b^T,   dX_b/dtheta = [X_b]x,   dX_b/dX = R_m_b^T
///
/// with poses as above.
class PointFactor final : public ceres::SizedCostFunction<3, 7, 3> {
 public:
  /// @param p_c z > 0
  /// @param bearing_sigma s_b, on the normalized image plane
  /// @param inverse_depth_sigma s_d [1/m]
  PointFactor(const Eigen::Vector3d& p_c, const Pose& T_b_c, double bearing_sigma,
              double inverse_depth_sigma);

  /// @return false for a landmark that is not before the camera
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector3d measured_;  ///< pi(p_c), 1 / z(p_c)
  Pose T_c_b_;
  Eigen::Vector3d inverse_sigmas_;
};

}  // namespace stillpoint
