// SPDX-License-Identifier: BSD-3-Clause
/// Real inertial samples and the attitude a motion capture system saw, cut into windows.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/imu/imu_buffer.h"
#include "core/types/trajectory.h"

namespace stillpoint {

/// Lines `ns,wx,wy,wz,ax,ay,az`; `#` begins a comment.
[[nodiscard]] ImuBuffer read_imu_csv(const std::filesystem::path& path);

/// Lines `s tx ty tz qx qy qz qw`; `#` begins a comment.
[[nodiscard]] std::vector<StampedPose> read_tum_poses(const std::filesystem::path& path);

/// Attitude at `t` by a parabola through the ground truth 50 ms to either side, or nothing where it is not to
/// be trusted: a hole of more than 20 ms in it, or more than 0.2 degrees RMS off that parabola (motion
/// capture that takes one marker for another jumps by degrees for a few samples). The IMU has no say in this.
[[nodiscard]] std::optional<Eigen::Quaterniond> trusted_attitude(const std::vector<StampedPose>& truth,
                                                                 Timestamp t);

/// A window of samples, and the rotation of the body over it.
struct RotationWindow {
  Timestamp begin;
  std::vector<ImuSample> samples;
  Eigen::Quaterniond q_bi_bj;
};

/// All windows of `length_s`, end to end from the first pose on, whose two attitudes can be trusted.
[[nodiscard]] std::vector<RotationWindow> rotation_windows(ImuBuffer& imu,
                                                           const std::vector<StampedPose>& truth,
                                                           double length_s);

}  // namespace stillpoint
