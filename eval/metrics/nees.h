// SPDX-License-Identifier: BSD-3-Clause
/// Normalized estimation error squared (NEES): consistency of an estimate with its covariance.
///
///   e_R = -Log(R_g R_e^T),  e_p = p_g - p_e,  NEES_R = e_R^T P_R^-1 e_R,  NEES_p = e_p^T P_p^-1 e_p
///
/// R_g, p_g: ground truth; R_e, p_e: estimate; P_R, P_p: covariances of rotation and position. Signs and
/// frames as in OpenVINS ov_eval; definition: Bar-Shalom et al., "Estimation with Applications to Tracking
/// and Navigation", 2001, Sec. 5.4.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "core/geometry/pose.h"
#include "core/types/trajectory.h"
#include "eval/metrics/honesty.h"

namespace stillpoint::eval {

/// The expectation of each is 3 (its degrees of freedom) for a consistent estimator.
struct Nees {
  double rotation = 0.0;
  double position = 0.0;
};

/// @param gt, est in the same world frame: align them first
/// @param rotation_covariance P_R [rad^2] of e_R, expressed in the world frame; positive definite
/// @param position_covariance P_p [m^2]; positive definite
/// @throws InputError if a covariance is not positive definite
[[nodiscard]] Nees nees(const Pose& gt, const Pose& est, const Eigen::Matrix3d& rotation_covariance,
                        const Eigen::Matrix3d& position_covariance);

/// Means over frames of NEES / 3: 1 for a consistent estimator, more if it claims too small an error.
struct MeanNees {
  double rotation = 0.0;
  double position = 0.0;
};

/// Mean over the located poses E_k of the first segment from 3 s after the first one, E_0, on. Claimed
/// covariances are relative to the first pose, so the true poses are E_0 G_0^-1 G_k, without an alignment
/// over the trajectory; they are interpolated to the time of the frame.
/// @param gt true poses of the same body frame
/// @param claims one per frame, in order of time; those without a positive definite covariance do not count
/// @return nullopt if no frame counts
[[nodiscard]] std::optional<MeanNees> mean_nees(const Trajectory& gt, std::span<const ClaimedPose> claims);

}  // namespace stillpoint::eval
