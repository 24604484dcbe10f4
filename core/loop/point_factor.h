// SPDX-License-Identifier: BSD-3-Clause
/// Residual of a landmark with measured depth in a keyframe.
#pragma once

#include <ceres/sized_cost_function.h>

#include "core/geometry/pose.h"

namespace stillpoint {

/// X: landmark in the map; p_c: measured position in the camera frame; pi(X) = (x, y) / z:
///
///   X_b = R_m_b^T (X - p_m_b),   X_c = T_b_c^-1 X_b
///   r = [ (pi(X_c) - pi(p_c)) / s_b ;  (1 / z(X_c) - 1 / z(p_c)) / s_d ]
///
///   dX_b/dp = -R_m_b^T,   dX_b/dtheta = [X_b]x,   dX_b/dX = R_m_b^T
///
/// with poses as in pose_graph_factors.h.
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
