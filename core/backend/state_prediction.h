// SPDX-License-Identifier: BSD-3-Clause
/// Where the camera is at a time that the window does not hold. Paper Sec. III-A ("IMU preintegration").
#pragma once

#include "core/imu/imu_buffer.h"
#include "core/types/motion_prior.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// What the estimator knows after a picture, as far as predictions need it: the feedback to the tracker.
struct MotionKnowledge {
  NavState newest;    ///< last state handed out
  NavState previous;  ///< the one before: constant velocity where there is no IMU
  Pose T_b_c;
  Eigen::Vector3d gravity_w = Eigen::Vector3d::Zero();
  double time_offset_s = 0.0;
  bool begun = false;     ///< a picture was taken in since the start or the last failure
  bool uses_imu = false;  ///< its biases and the time offset mean something
  bool inertial = false;  ///< gravity and speed are known
};

/// State at an image stamp not before the newest one: inertial propagation, or constant velocity.
[[nodiscard]] NavState extrapolate(const MotionKnowledge& known, ImuBuffer& imu, Timestamp t);

/// Forgets samples that nothing needs any more which follows the newest state.
void forget_spent(const MotionKnowledge& known, ImuBuffer& imu);

/// How the camera moved between two pictures, for the tracker; the newest state is not after `from`.
/// Inertial data only: a tracker that starts where constant velocity puts weak features finds them there,
/// and the estimate follows itself.
[[nodiscard]] MotionPrior motion_prior(const MotionKnowledge& known, ImuBuffer& imu, Timestamp from,
                                       Timestamp to);

}  // namespace stillpoint
