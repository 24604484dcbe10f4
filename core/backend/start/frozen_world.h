// SPDX-License-Identifier: BSD-3-Clause
/// Visual-inertial alignment for `GravityModel::kEstimated`: the world stays as it is, gravity is a state.
#pragma once

#include "core/backend/start/initializer.h"

namespace stillpoint {

/// The linear system A [v_0, g, s - 1] = y of `align_with_imu`; without the last column if the poses are
/// metric.
struct AlignmentEquations {
  const Eigen::MatrixXd& A;
  const Eigen::VectorXd& y;
};

/// Two orthonormal vectors orthogonal to `direction`, which may have any length but 0.
[[nodiscard]] Eigen::Matrix<double, 3, 2> orthogonal_vectors(const Eigen::Vector3d& direction);

/// (A^T A)^-1: the covariance of the least-squares solution of A x = y for residuals of unit variance.
[[nodiscard]] Eigen::MatrixXd least_squares_covariance(const Eigen::MatrixXd& A);

/// Covariance of the direction g / |g| in its tangent plane, 3x3 of rank 2: that of the least squares over
/// v_0, the two tangent directions of g and s, with the variance of the residuals, plus that of an
/// accelerometer bias, which the system cannot tell from gravity.
/// @param gravity_w refined solution of the system
/// @param accel_bias_sigma [m/s^2]
[[nodiscard]] Eigen::Matrix3d gravity_direction_covariance(const AlignmentEquations& equations,
                                                           const Eigen::Vector3d& gravity_w,
                                                           double accel_bias_sigma);

/// `apply_alignment` with the covariance of gravity. The covariance is weak, a hundred times that of the
/// alignment, because the window contains the samples of the alignment.
///
/// If gravity is known already (`Window::gravity_covariance`, after a restart), the world is kept: frame 0
/// has the pose `anchor`, and gravity keeps its value and covariance unless the alignment contradicts it
/// (squared Mahalanobis distance above the 0.999 quantile): then the attitude was lost, and gravity is that
/// of the alignment.
void apply_alignment_to_frozen_world(const InertialAlignment& alignment, const Pose& anchor, Window& window);

}  // namespace stillpoint
