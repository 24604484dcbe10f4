// SPDX-License-Identifier: BSD-3-Clause
/// `rig.toml`: a calibration given by hand, which overrides that of the sequence's format.
#pragma once

#include <filesystem>

#include "core/types/rig.h"

namespace stillpoint {

/// A rig, and whether the file said where the IMU sits.
struct OverriddenRig {
  Rig rig;
  bool has_extrinsic = false;
};

/// Changes the values of `rig` that the file names:
///   [camera] width height fx fy cx cy model distortion rolling_shutter_s    (px, s; model as in enum_names)
///   [depth]  scale                                                          (raw units of one metre)
///   [imu]    T_b_c gyro_noise accel_noise gyro_walk accel_walk time_offset_s
/// T_b_c are 16 numbers, row by row; the units of the others are those of `ImuNoise` and `Rig`.
/// @throws InputError with file and line on an unknown key, a wrong type or a value out of range
[[nodiscard]] OverriddenRig apply_rig_file(const std::filesystem::path& file, const Rig& rig);

}  // namespace stillpoint
