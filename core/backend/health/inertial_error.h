// SPDX-License-Identifier: BSD-3-Clause
/// Errors of inertial data, by comparison with poses that were determined by vision.
#pragma once

#include <optional>

#include "core/imu/imu_buffer.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// A pose determined by vision alone.
struct VisualPose {
  Timestamp t;  ///< on the IMU clock
  Pose T_w_b;
  double sigma_m = 0.0;
  double sigma_rad = 0.0;
  int features = 0;  ///< that agree with it
};

struct InertialError {
  Eigen::Vector3d accel_w;   ///< a: constant error of the accelerometer that explains the difference [m/s^2]
  Eigen::Vector3d gyro_b;    ///< w: same for the gyroscope, in the last body frame [rad/s]
  double accel_sigma = 0.0;  ///< of |a|, due to the visual poses
  double gyro_sigma = 0.0;   ///< of |w|, likewise
  Eigen::Vector3d accel_change_w;  ///< mean specific force of the second interval less that of the first
  Eigen::Vector3d gyro_change_b;   ///< same for the angular rate

  /// Largest ratio of an error to its limit: |a| to 3 m/s^2, |w| to 0.1 rad/s, each plus four standard
  /// deviations.
  [[nodiscard]] double severity() const;

  /// Whether the data of a sensor changed as it does when it becomes wrong, during a shock or after a step of
  /// a bias. With the changes f of the specific force and r of the angular rate:
  ///
  ///   a.f >= 0.7 |a| |f|,  |f| >= 0.4 |a|    and the same for w and r
  ///
  /// A person who starts to move in front of the camera contradicts sound inertial data, too, but does not
  /// change it. The small error of a sound sensor is sometimes explained by chance.
  [[nodiscard]] bool accel_is_explained() const;
  [[nodiscard]] bool gyro_is_explained() const;
  /// Either of them.
  [[nodiscard]] bool is_explained() const { return accel_is_explained() || gyro_is_explained(); }
};

/// Three poses in temporal order.
struct VisualPoses {
  const VisualPose& A;
  const VisualPose& B;
  const VisualPose& C;
};

/// Compares the preintegrated motion between three visual poses A, B, C with these poses; independent of the
/// estimated velocity. With the intervals T1, T2, gravity g, and the preintegrated dp1, dv1 (A to B) and dp2
/// (B to C), the velocity at B follows from either interval:
///
///   v_1 = (p_B - p_A) / T1 + 1/2 g T1 + R_A (dv1 - dp1 / T1)
///   v_2 = (p_C - p_B) / T2 - 1/2 g T2 - R_B dp2 / T2
///
/// A constant error a of the accelerometer gives v_1 - v_2 = a (T1 + T2) / 2; an error w of the gyroscope
/// turns R_C by w (T1 + T2).
/// @param state biases
/// @return nullopt if samples are missing
[[nodiscard]] std::optional<InertialError> inertial_error(const VisualPoses& poses, const NavState& state,
                                                          const Eigen::Vector3d& gravity_w, ImuBuffer& imu);

}  // namespace stillpoint
