// SPDX-License-Identifier: BSD-3-Clause
/// IMU-rate poses between the estimator's states, and the motion prior for the tracker. Paper Sec. II and
/// III-A.
#pragma once

#include <vector>

#include "core/types/imu_sample.h"
#include "core/types/motion_prior.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// States at each sample after the first, by midpoint integration from `start` with its biases.
/// @param samples rising; the first is at start.t
/// @param gravity_w e.g. (0, 0, -9.81) [m/s^2]
[[nodiscard]] std::vector<NavState> propagate(const NavState& start, const std::vector<ImuSample>& samples,
                                              const Eigen::Vector3d& gravity_w);

/// Rotation-only prior from gyroscope samples between two exposures. Invalid (no rotation) with fewer than
/// two samples.
[[nodiscard]] MotionPrior rotation_prior(const std::vector<ImuSample>& samples,
                                         const Eigen::Vector3d& gyro_bias, const Pose& T_b_c);

/// Full prior from the body's states at the two exposures.
[[nodiscard]] MotionPrior full_prior(const Pose& T_w_bprev, const Pose& T_w_bcur, const Pose& T_b_c);

}  // namespace stillpoint
