// SPDX-License-Identifier: BSD-3-Clause
/// From a visual window to a level inertial one: gyro bias, gravity, speeds, and the scale where no depth
/// gives it. Qin et al. 2018 (VINS-Mono), Sec. V-B.
#pragma once

#include <optional>

#include "core/backend/backend_config.h"
#include "core/backend/window.h"

namespace stillpoint {

/// What visual motion and inertial samples of a window agree on.
struct InertialAlignment {
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d gravity_w =
      Eigen::Vector3d::Zero();  ///< in the visual world [m/s^2], of the configured length
  Eigen::Vector3d first_velocity_w = Eigen::Vector3d::Zero();  ///< of frame 0 [m/s]
  double scale = 1.0;                                          ///< metres in one unit of the visual world
  double free_gravity = 0.0;  ///< length of gravity when it is not held [m/s^2]: a check
};

/// Neither a static start nor parallax is needed, only poses; they are of metric scale except with the
/// monocular initialiser, which looks for the scale too.
/// @param window not inertial, every frame but the first with inertial samples
/// @param gravity length [m/s^2]
/// @return nothing if samples are missing, the free gravity is off by more than the tolerance, or the scale
/// is less certain than configured
[[nodiscard]] std::optional<InertialAlignment> align_with_imu(const Window& window, double gravity,
                                                              const InitializerConfig& config);

/// Scales the window to metres, turns its world so that gravity points along -z and the body of frame 0 is
/// where `anchor` says (position and heading), sets speeds and biases, and repropagates the samples.
void make_inertial(const InertialAlignment& alignment, const Pose& anchor, Window& window);

/// The prior on a window that has none: frame 0 holds the gauge, and its biases their uncertainty.
[[nodiscard]] LinearPrior first_prior(const Window& window, const InitializerConfig& config);

/// Camera in body and time offset are as the window has them now, within the configured uncertainty.
[[nodiscard]] LinearPrior calibration_prior(const Window& window, const BackendConfig& config);

}  // namespace stillpoint
