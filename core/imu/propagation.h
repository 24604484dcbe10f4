// SPDX-License-Identifier: BSD-3-Clause
/// Propagation of a state by inertial samples, and the motion prior of the tracker. Paper Sec. II and III-A.
#pragma once

#include <span>

#include "core/types/imu_sample.h"
#include "core/types/motion_prior.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// State at the last sample by midpoint integration from `start` with its biases. Per step, with the rotation
/// and mean specific force f of midpoint_step in the world frame: a = f + g, p += v dt + 1/2 a dt^2, v += a
/// dt. Returns `start` for fewer than two samples.
/// @param start its biases are held constant
/// @param samples sorted by time; the first is at start.t
/// @param gravity_w e.g. (0, 0, -9.81) [m/s^2]
[[nodiscard]] NavState propagate(const NavState& start, std::span<const ImuSample> samples,
                                 const Eigen::Vector3d& gravity_w);

/// Rotation-only prior from gyroscope samples between two exposures. `has_rotation` is false for fewer than
/// two samples.
[[nodiscard]] MotionPrior rotation_prior(std::span<const ImuSample> samples, const Eigen::Vector3d& gyro_bias,
                                         const Pose& T_b_c);

/// Full prior from the body poses at the two exposures.
[[nodiscard]] MotionPrior full_prior(const Pose& T_w_bprev, const Pose& T_w_bcur, const Pose& T_b_c);

}  // namespace stillpoint
