// SPDX-License-Identifier: BSD-3-Clause
/// The error of inertial data that explains its difference from vision, over two successive intervals between
/// three visual poses.
#pragma once

#include <optional>

#include "core/backend/vision/feature_views.h"
#include "core/imu/imu_buffer.h"
#include "core/types/nav_state.h"

namespace stillpoint {

struct InertialError {
  Eigen::Vector3d accel_w;   ///< a: constant error of the accelerometer that explains the difference [m/s^2]
  Eigen::Vector3d gyro_b;    ///< w: same for the gyroscope, in the last body frame [rad/s]
  double accel_sigma = 0.0;  ///< of a along its least certain direction, due to the visual poses
  double gyro_sigma = 0.0;   ///< of w, likewise
  Eigen::Vector3d accel_change_w;  ///< mean specific force of the second interval less that of the first
  Eigen::Vector3d gyro_change_b;   ///< same for the angular rate

  /// Ratios of the errors to their limits: |a| to 3 m/s^2, |w| to 0.1 rad/s, each plus four standard
  /// deviations.
  [[nodiscard]] double accel_severity() const;
  [[nodiscard]] double gyro_severity() const;

  /// Whether the data of a sensor changed as it does when it becomes wrong, during a shock or after a step of
  /// a bias. With the changes f of the specific force and r of the angular rate:
  ///
  ///   a.f >= 0.7 |a| |f|,  |f| >= 0.4 |a|    and the same for w and r
  ///
  /// A person who starts to move in front of the camera contradicts sound inertial data, too, but does not
  /// change it. The small error of a sound sensor is sometimes explained by chance.
  [[nodiscard]] bool accel_is_explained() const;
  [[nodiscard]] bool gyro_is_explained() const;
};

/// Three poses in temporal order.
struct VisualPoses {
  using Covariance = Eigen::Matrix<double, 18, 18>;

  const VisualPose& A;
  const VisualPose& B;
  const VisualPose& C;
  Covariance covariance;  ///< of (dp_A, dtheta_A, dp_B, dtheta_B, dp_C, dtheta_C), see UncertainPose
};

/// Poses with independent errors: each was found by known positions of its features.
[[nodiscard]] VisualPoses independent_poses(const VisualPose& A, const VisualPose& B, const VisualPose& C);

/// Poses of which A is exact, and B and C were computed from the pose before with independent errors (rho,
/// phi) of the motion:
///
///   dp_B = R_A rho_1,                                   dtheta_B = phi_1,
///   dp_C = R_A rho_1 - R_B [p_BC]x phi_1 + R_B rho_2,   dtheta_C = R_BC^T phi_1 + phi_2.
[[nodiscard]] VisualPoses chained_poses(const VisualPose& A, const VisualPose& B, const VisualPose& C);

/// Compares the preintegrated motion between three visual poses A, B, C with these poses; independent of the
/// estimated velocity. With the intervals T1, T2, gravity g, and the preintegrated dp1, dv1 (A to B) and dp2
/// (B to C), the velocity at B follows from either interval:
///
///   v_1 = (p_B - p_A) / T1 + 1/2 g T1 + R_A (dv1 - dp1 / T1)
///   v_2 = (p_C - p_B) / T2 - 1/2 g T2 - R_B dp2 / T2
///
/// A constant error a of the accelerometer gives v_1 - v_2 = a (T1 + T2) / 2; an error w of the gyroscope
/// turns R_C by w (T1 + T2). With T = T1 + T2, f1 = dv1 - dp1 / T1 and f2 = dp2 / T2, errors of the poses
/// give
///
///   a: 2/T (-dp_A / T1 - R_A [f1]x dtheta_A + (1/T1 + 1/T2) dp_B - R_B [f2]x dtheta_B - dp_C / T2)
///   w: 1/T ((dR1 dR2)^T dtheta_A - dtheta_C),
///
/// where f1 and f2 are about -g T1 / 2 and -g T2 / 2: an error of the attitude turns gravity.
/// @param state biases
/// @return nullopt if samples are missing
[[nodiscard]] std::optional<InertialError> inertial_error(const VisualPoses& poses, const NavState& state,
                                                          const Eigen::Vector3d& gravity_w, ImuBuffer& imu);

}  // namespace stillpoint
