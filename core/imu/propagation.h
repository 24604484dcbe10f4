// SPDX-License-Identifier: BSD-3-Clause
/// The pose at inertial samples after the estimator's newest state, and the motion prior for the tracker.
/// Paper Sec. II and III-A.
#pragma once

#include <span>

#include "core/types/imu_sample.h"
#include "core/types/motion_prior.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// State at the last sample, by midpoint integration from `start` with its biases; `start` itself with fewer
/// than two samples.
/// @param samples rising; the first is at start.t
/// @param gravity_w e.g. (0, 0, -9.81) [m/s^2]
[[nodiscard]] NavState propagate(const NavState& start, std::span<const ImuSample> samples,
                                 const Eigen::Vector3d& gravity_w);

/// Rotation-only prior from gyroscope samples between two exposures. Invalid (no rotation) with fewer than
/// two samples.
[[nodiscard]] MotionPrior rotation_prior(std::span<const ImuSample> samples, const Eigen::Vector3d& gyro_bias,
                                         const Pose& T_b_c);

/// Full prior from the body's states at the two exposures.
[[nodiscard]] MotionPrior full_prior(const Pose& T_w_bprev, const Pose& T_w_bcur, const Pose& T_b_c);

}  // namespace stillpoint
