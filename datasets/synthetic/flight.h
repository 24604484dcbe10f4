// SPDX-License-Identifier: BSD-3-Clause
/// A real flight, made ready to be rendered along: its path smoothed, its readings as they were.
#pragma once

#include "datasets/synthetic/imu_model.h"
#include "datasets/synthetic/inertial_smoother.h"
#include "datasets/synthetic/presets.h"

namespace stillpoint {

struct Flight {
  SmoothedFlight smoothed;
  Timestamp epoch;          ///< stamp of path time 0: the first picture
  InertialRecord readings;  ///< unchanged
  Pose T_b_c;
};

inline constexpr double kFlightMargin_s = 0.5;  ///< fitted and read beyond both ends of the pictures

/// Reads the flight of `request`, from `start_s` after the first moment that both files cover.
/// @throws InputError if a file cannot be read, or they do not cover the wanted span
[[nodiscard]] Flight load_flight(const SynthRequest& request);

/// A camera that looks level when the body is as `up_b` says: EuRoC's left camera where the IMU's x axis
/// points up, else along -y (as on TUM-VI's board) for an IMU whose z axis points up.
/// @param up_b mean specific force of the body; its direction is up
/// @throws InputError if no axis of the IMU is within 45 degrees of it
[[nodiscard]] Pose flight_T_b_c(const Eigen::Vector3d& up_b);

}  // namespace stillpoint
