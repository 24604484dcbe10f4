// SPDX-License-Identifier: BSD-3-Clause
/// Recorded motion to render along: smoothed trajectory and original IMU samples.
#pragma once

#include "datasets/synthetic/motion/imu_model.h"
#include "datasets/synthetic/motion/inertial_smoother.h"
#include "datasets/synthetic/sequence/presets.h"

namespace stillpoint::synth {

struct RecordedMotion {
  SmoothedMotion smoothed;
  Timestamp epoch;     ///< timestamp of path time 0, the first frame
  ImuRecord readings;  ///< as recorded
  Pose T_b_c;
};

inline constexpr double kRecordingMargin_s = 0.5;  ///< data used beyond the first and last frame

/// Loads and smooths the recording of `request`, from `start_s` after the first time that both files cover.
/// @throws InputError if a file cannot be read or the files do not cover the requested interval
[[nodiscard]] RecordedMotion load_recorded_motion(const SynthRequest& request);

/// Extrinsics of a virtual camera that looks approximately horizontally: EuRoC's left camera if the x axis of
/// the IMU points up; looking along -y (as on the TUM-VI rig) if its z axis points up.
/// @param up_b mean specific force in the body frame, which points up
/// @throws InputError if neither axis is within 45 degrees of it
[[nodiscard]] Pose virtual_camera_T_b_c(const Eigen::Vector3d& up_b);

}  // namespace stillpoint::synth
