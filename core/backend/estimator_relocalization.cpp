// SPDX-License-Identifier: BSD-3-Clause
// Return of the estimator to the map of trusted landmarks after a loss of vision.
#include "core/backend/estimator.h"

namespace stillpoint {
namespace {

/// 99 % quantile of the chi-square distribution with six degrees of freedom.
constexpr double kMaxPoseDistance = 16.81;

}  // namespace

/// Pose at `t` by inertial data alone, with the covariance that the optimization claims, propagated as in
/// Preintegration. It includes the drift before the loss of vision, which the map shares: after a long path
/// it is larger than the error by which the map and this pose differ.
std::optional<UncertainPose> Estimator::dead_reckoned_pose(Timestamp t) {
  if (window_.frames.empty() || !window_.inertial) return std::nullopt;
  const std::optional<WindowCovariance> claim =
      solver_->covariance(window_, pixel_noise_.applied_to(backend_), rig_.camera.focal_px(), false);
  const double offset_s = window_.time_offset_s;
  const std::vector<ImuSample>& samples = imu_.samples_up_to(after(newest_.t, offset_s), after(t, offset_s));
  if (!claim || samples.size() < 2) return std::nullopt;
  Preintegration motion(rig_.imu_noise, newest_.gyro_bias, newest_.accel_bias);
  motion.integrate(samples);
  // In the newest body frame, as the errors of the preintegration.
  Matrix15 Q = Matrix15::Identity();
  Q.block<3, 3>(ImuErrorIndex::kPosition, ImuErrorIndex::kPosition) = newest_.T_w_b.R();
  Q.block<3, 3>(ImuErrorIndex::kVelocity, ImuErrorIndex::kVelocity) = newest_.T_w_b.R();
  const Matrix15 J = Q * motion.jacobian() * Q.transpose();
  const Matrix15 covariance =
      J * claim->newest.state * J.transpose() + Q * motion.covariance() * Q.transpose();
  return UncertainPose{motion.predict(newest_, window_.gravity_w).T_w_b, covariance.topLeftCorner<6, 6>()};
}

/// While dead reckoning or lost: restarts the window at the pose found in the map of trusted landmarks. While
/// dead reckoning, a pose that contradicts the claimed covariance is not used, one that differs by no more
/// than its own error confirms dead reckoning, and any other is fused with it.
void Estimator::relocalize(const TrackedFrame& frame) {
  const Pose predicted = extrapolate(motion_state(), imu_, frame.t).T_w_b;
  const std::optional<UncertainPose> on_map = monitor_.relocalize(frame, predicted * window_.T_b_c);
  if (!on_map) return;
  UncertainPose found = in_frame(*on_map, window_.T_b_c.inverse());
  if (!monitor_.awaits_map()) {
    if (const std::optional<UncertainPose> reckoned = dead_reckoned_pose(frame.t)) {
      const Pose& T_w_b = reckoned->T_w_f;
      const bool confirmed = squared_distance(T_w_b, found.T_w_f, found.covariance) <= kMaxPoseDistance;
      const bool agrees =
          squared_distance(T_w_b, found.T_w_f, reckoned->covariance + found.covariance) <= kMaxPoseDistance;
      if (confirmed || !agrees) return;
      found = fuse(*reckoned, found);
    }
  }
  restart(window_.gravity_w);
  newest_.T_w_b = found.T_w_f;
  newest_.t = frame.t;
  previous_ = newest_;
  monitor_.relocated();
}

}  // namespace stillpoint
