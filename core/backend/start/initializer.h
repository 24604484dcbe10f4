// SPDX-License-Identifier: BSD-3-Clause
/// Visual-inertial alignment: gyro bias, gravity, velocities, and the scale if depth is off. Qin et al. 2018
/// (VINS-Mono), Sec. V-B. With `GravityModel::kEstimated` the world stays as it is, and gravity is a state.
#pragma once

#include <optional>

#include "core/backend/window/window.h"
#include "core/config/backend_config.h"

namespace stillpoint {

/// Result of the visual-inertial alignment of a window.
struct InertialAlignment {
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d gravity_w = Eigen::Vector3d::Zero();  ///< in the visual world, of configured norm [m/s^2]
  Eigen::Matrix3d gravity_covariance =
      Eigen::Matrix3d::Zero();  ///< of gravity_w / |gravity_w|, in the tangent plane
  Eigen::Vector3d first_velocity_w = Eigen::Vector3d::Zero();  ///< of frame 0 [m/s]
  double scale = 1.0;                                          ///< meters per unit of the visual world
  double unconstrained_gravity = 0.0;  ///< norm of gravity without the norm constraint [m/s^2]
  double position_sigma = 0.0;         ///< of the equations that the alignment solves, by their residuals [m]
};

/// Aligns the visual poses of a window with its preintegrated IMU data. The poses are metric except with the
/// monocular initializer, which estimates the scale as well. No static start is required.
///
/// 1. Gyro bias: least squares on the rotation differences of successive frames (see preintegration.h).
/// 2. Linear alignment. Integrating from frame 0 with the visual attitudes R_k gives velocity and position
///    due to specific force alone,
///
///      beta_k  = beta_(k-1) + R_(k-1) delta_v_k,
///      alpha_k = alpha_(k-1) + beta_(k-1) dt_k + R_(k-1) delta_p_k,
///
///    and with the body positions p_k, camera positions c_k, T_k = t_k - t_0 and scale s, each frame k gives
///
///      p_k - p_0 - alpha_k = v_0 T_k + 1/2 g T_k^2 + (s - 1) (c_0 - c_k),
///
///    linear in v_0, g and s - 1 (s = 1 and no last column if the poses are metric). The scale applies to
///    the camera positions only, not to the camera-IMU lever arm.
/// 3. Gravity refinement: g = |g| normalized(g' + B w), with B a basis of the tangent plane at the current
///    g', reduces g to two unknowns w of configured norm; solved four times.
///
/// @param window visual; every frame but the first with inertial samples
/// @param gravity configured norm [m/s^2]
/// @return nothing if samples are missing or unreliable, the norm of g after step 2 deviates by more than
/// `gravity_tolerance`, or the relative standard deviation of s exceeds `max_scale_sigma`
[[nodiscard]] std::optional<InertialAlignment> align_with_imu(const Window& window, double gravity,
                                                              const InitializerConfig& config);

/// Applies an alignment: scales the window to meters, transforms its world such that gravity points along -z
/// and frame 0 has the position and heading of `anchor`, sets velocities and biases, and repropagates the
/// samples.
void apply_alignment(const InertialAlignment& alignment, const Pose& anchor, Window& window);

/// `apply_alignment` with the covariance of gravity. The covariance is weak, a hundred times that of the
/// alignment, because the window contains the samples of the alignment.
///
/// If gravity is known already (`Window::gravity_covariance`, after a restart), the world is kept: frame 0
/// has the pose `anchor`, and gravity keeps its value and covariance unless the alignment contradicts it
/// (squared Mahalanobis distance above the 0.999 quantile): then the attitude was lost, and gravity is that
/// of the alignment. If the positions deviate from it by more than 5 mm, they are not those of the camera
/// alone, e.g. because the first ones follow a person who then left, and the next window is to be aligned.
/// @return whether the alignment is applied; else the window is not to be used
[[nodiscard]] bool apply_alignment_to_frozen_world(const InertialAlignment& alignment, const Pose& anchor,
                                                   Window& window);

}  // namespace stillpoint
