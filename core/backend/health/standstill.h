// SPDX-License-Identifier: BSD-3-Clause
/// Detection of a camera at rest, by inertial data and features that agree.
#pragma once

#include "core/backend/window/window.h"
#include "core/config/backend_config.h"
#include "core/imu/imu_buffer.h"

namespace stillpoint {

/// Calibration that the detection uses.
struct StandstillModel {
  ImuNoise noise;
  double gravity = 9.81;  ///< norm [m/s^2]
  double focal_px = 500.0;
};

/// Whether the body was at rest before the exposure of the newest frame. All of these must hold:
/// - `zero_velocity_statistic` of the samples of the last 0.2 s is at most `statistic`,
/// - the predicted speed is at most 0.1 m/s, because neither that nor far features exclude constant velocity,
/// - since a frame at least 0.2 s older, at least `min_static_ratio` of the common features, and at least
/// ten,
///   have moved by at most `static_px` in the image. All others may move: people in front of the camera.
[[nodiscard]] bool is_at_rest(const Window& window, ImuBuffer& imu, const ZeroVelocityConfig& config,
                              const StandstillModel& model);

}  // namespace stillpoint
