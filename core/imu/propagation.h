// SPDX-License-Identifier: BSD-3-Clause
/// Propagation of a state by inertial samples, and the motion prior of the tracker (Paper Sec. II and III-A),
/// by the midpoint step that preintegration uses as well (Qin et al. 2018, VINS-Mono, Sec. IV-B).
#pragma once

#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geometry/so3.h"
#include "core/types/nav_state.h"
#include "core/types/rig.h"

namespace stillpoint {

/// Biases to subtract from the samples: gyro [rad/s], accel [m/s^2].
struct ImuBias {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();
};

/// Rotation vector theta = ((w_0 + w_1) / 2 - b_g) dt between two samples [rad].
[[nodiscard]] inline Eigen::Vector3d midpoint_rotation(const ImuSample& from, const ImuSample& to,
                                                       const Eigen::Vector3d& gyro_bias) {
  const double dt = seconds_between(from.t, to.t);
  return (0.5 * (from.gyro_b + to.gyro_b) - gyro_bias) * dt;
}

/// Result of a step; r is the reference frame of the attitude.
struct MidpointStep {
  Eigen::Quaterniond q_r_b;  ///< attitude after the step
  Eigen::Vector3d force_r;   ///< mean specific force of both ends [m/s^2]
  Eigen::Vector3d theta;     ///< rotation during the step, in the body frame [rad]
  Eigen::Vector3d force_to;  ///< bias-corrected specific force at the end, in the body frame there [m/s^2]
};

/// q_1 = q_0 Exp(theta),  f = 1/2 (q_0 (a_0 - b_a) + q_1 (a_1 - b_a)), with 0 = `from`, 1 = `to`.
/// @param q_r_b q_0: attitude at `from`
/// @param from, to consecutive samples
/// @param bias b_g and b_a
[[nodiscard]] inline MidpointStep midpoint_step(const Eigen::Quaterniond& q_r_b, const ImuSample& from,
                                                const ImuSample& to, const ImuBias& bias) {
  MidpointStep step;
  step.theta = midpoint_rotation(from, to, bias.gyro);
  step.q_r_b = (q_r_b * exp_so3(step.theta)).normalized();
  step.force_to = to.accel_b - bias.accel;
  step.force_r = 0.5 * (q_r_b * (from.accel_b - bias.accel) + step.q_r_b * step.force_to);
  return step;
}

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
