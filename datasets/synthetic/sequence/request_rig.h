// SPDX-License-Identifier: BSD-3-Clause
/// The sensors with which a sequence is rendered.
#pragma once

#include <filesystem>

#include "core/geometry/pose.h"
#include "core/types/rig.h"
#include "datasets/synthetic/sequence/presets.h"

namespace stillpoint::synth {

/// Camera pose in the body frame unless a rig file states another: RealSense D435i, color camera to IMU.
[[nodiscard]] Pose realsense_T_b_c();

/// Takes the sensors of a rig file (`datasets::apply_rig_file`) for a request. Image size, focal length,
/// read-out time, depth unit, inertial noise and time offset become its fields; the file remains part of it
/// for the intrinsics and the pose of the camera. Read-out time and time offset are rendered; the calibration
/// that is written with the sequence does not state them.
/// @throws InputError as `apply_rig_file`; for a fisheye camera, for distortion that has no ray for some
/// pixel, and for a depth camera of its own: depth images are rendered in the color camera
void use_rig(SynthRequest& request, const std::filesystem::path& file);

/// Calibration of the rendered sequence. Without a rig file, a pinhole camera whose principal point is the
/// image center.
/// @throws InputError as `use_rig`
[[nodiscard]] Rig rig_of(const SynthRequest& request);

}  // namespace stillpoint::synth
