// SPDX-License-Identifier: BSD-3-Clause
/// Recorded inertial samples and motion capture attitudes, split into windows.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/imu/imu_buffer.h"
#include "core/types/trajectory.h"

namespace stillpoint {

/// Lines `ns,wx,wy,wz,ax,ay,az`; `#` starts a comment.
[[nodiscard]] ImuBuffer read_imu_csv(const std::filesystem::path& path);

/// Lines `s tx ty tz qx qy qz qw`; `#` starts a comment.
[[nodiscard]] std::vector<StampedPose> read_tum_poses(const std::filesystem::path& path);

/// Attitude at `t` by a parabola fitted to the ground truth within +-50 ms, or nothing if it is unreliable: a
/// gap of more than 20 ms, or an RMS residual above 0.2 degrees (motion capture that confuses markers jumps
/// by degrees for a few samples). Independent of the IMU.
[[nodiscard]] std::optional<Eigen::Quaterniond> reliable_attitude(const std::vector<StampedPose>& truth,
                                                                  Timestamp t);

/// A window of samples and the rotation of the body over it.
struct RotationWindow {
  Timestamp begin;
  std::vector<ImuSample> samples;
  Eigen::Quaterniond q_bi_bj;
};

/// All consecutive windows of `length_s` from the first pose on with reliable attitudes at both ends.
[[nodiscard]] std::vector<RotationWindow> rotation_windows(ImuBuffer& imu,
                                                           const std::vector<StampedPose>& truth,
                                                           double length_s);

}  // namespace stillpoint
