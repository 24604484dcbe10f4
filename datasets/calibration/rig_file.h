// SPDX-License-Identifier: BSD-3-Clause
/// Rig files: a user-provided calibration that overrides the calibration of the sequence format, as
/// `rig.toml` or as YAML of another program.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/types/rig.h"
#include "datasets/calibration/depth_registration.h"

namespace stillpoint::datasets {

struct OverriddenRig {
  Rig rig;
  bool has_extrinsic = false;               ///< whether the file contains the camera-IMU extrinsic
  std::optional<DepthCamera> depth_camera;  ///< set if the depth images are those of another camera
  std::vector<std::string> notes;           ///< of a YAML file: what was read of it
};

/// Replaces the values of `rig` that the file sets:
///   [camera] width height fx fy cx cy model distortion rolling_shutter_s    (px, s; model as in enum_names)
///   [depth]  scale offset                                  (raw units per meter; `Rig::depth_offset`, 1/m)
///            width height fx fy cx cy T_c_d          (camera of depth images that are not registered; px)
///   [imu]    T_b_c gyro_noise accel_noise gyro_walk accel_walk time_offset_s gyro_axes accel_axes
/// T_b_c and T_c_d are 4x4 matrices in row-major order, gyro_axes and accel_axes 3x3 ones (`ImuAxes`); the
/// units of the others are those of `ImuNoise` and `Rig`. YAML, by the first line or the extension, is read
/// by `apply_rig_yaml`.
/// @throws InputError with file and line on an unknown key, a wrong type, a value out of range, or a missing
/// value of a depth camera, or of a color camera of which `rig` contains nothing
[[nodiscard]] OverriddenRig apply_rig_file(const std::filesystem::path& file, const Rig& rig);

/// Whether they may be those of an inertial sensor (see `ImuAxes`): each number within 0.2 of the identity.
/// Others are wrong units, or swapped axes.
[[nodiscard]] bool are_plausible_axes(const Eigen::Matrix3d& axes);

/// A rig file with all values of `rig` but `imu_axes` and `depth_offset`, as samples and images that are
/// written with it are corrected already; numbers are exact.
/// @param with_extrinsic whether to write T_b_c, whose rotation is rounded when it is read
[[nodiscard]] std::string rig_file_text(const Rig& rig, bool with_extrinsic = true);

}  // namespace stillpoint::datasets
