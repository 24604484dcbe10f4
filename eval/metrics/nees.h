// SPDX-License-Identifier: BSD-3-Clause
/// Whether an estimate's covariance tells the truth: normalised estimation error squared.
#pragma once

#include <Eigen/Core>

#include "core/geometry/pose.h"

namespace stillpoint {

/// Each has expectation 3 for a consistent estimate.
struct Nees {
  double rotation = 0.0;
  double position = 0.0;
};

/// As OpenVINS ov_eval: e_R = -Log(R_g R_e^T), e_p = p_g - p_e in the world, each e^T P^-1 e.
/// @param rotation_covariance [rad^2], of the rotation error in the world; positive definite
/// @param position_covariance [m^2]; positive definite
/// @throws InputError if a covariance is not positive definite
[[nodiscard]] Nees nees(const Pose& gt, const Pose& est, const Eigen::Matrix3d& rotation_covariance,
                        const Eigen::Matrix3d& position_covariance);

}  // namespace stillpoint
