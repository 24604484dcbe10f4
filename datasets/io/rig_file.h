// SPDX-License-Identifier: BSD-3-Clause
/// `rig.toml`: a user-provided calibration that overrides the calibration of the sequence format.
#pragma once

#include <filesystem>
#include <string>

#include "core/types/rig.h"

namespace stillpoint::datasets {

/// A rig, and whether the file contains the camera-IMU extrinsic.
struct OverriddenRig {
  Rig rig;
  bool has_extrinsic = false;
};

/// Replaces the values of `rig` that the file sets:
///   [camera] width height fx fy cx cy model distortion rolling_shutter_s    (px, s; model as in enum_names)
///   [depth]  scale                                                          (raw units per meter)
///   [imu]    T_b_c gyro_noise accel_noise gyro_walk accel_walk time_offset_s
/// T_b_c is a 4x4 matrix in row-major order; the units of the others are those of `ImuNoise` and `Rig`.
/// @throws InputError with file and line on an unknown key, a wrong type, a value out of range, or a missing
/// value of a camera of which `rig` contains nothing
[[nodiscard]] OverriddenRig apply_rig_file(const std::filesystem::path& file, const Rig& rig);

/// A rig file with all values of `rig`; numbers are exact.
/// @param with_extrinsic whether to write T_b_c, whose rotation is rounded when it is read
[[nodiscard]] std::string rig_file_text(const Rig& rig, bool with_extrinsic = true);

}  // namespace stillpoint::datasets
