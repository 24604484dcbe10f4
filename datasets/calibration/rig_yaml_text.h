// SPDX-License-Identifier: BSD-3-Clause
/// Calibrations as the YAML that other programs read, the inverse of datasets/calibration/rig_yaml.h.
#pragma once

#include <string>

#include "core/base/fields.h"
#include "core/types/rig.h"

namespace stillpoint::datasets {

enum class RigFormat { kStillpoint, kKalibr, kOpenvins, kOpencv, kOrbSlam, kVins };
constexpr auto enum_names(RigFormat) {
  return EnumNames<RigFormat, 6>{{{RigFormat::kStillpoint, "toml"},
                                  {RigFormat::kKalibr, "kalibr"},
                                  {RigFormat::kOpenvins, "openvins"},
                                  {RigFormat::kOpencv, "opencv"},
                                  {RigFormat::kOrbSlam, "orb_slam"},
                                  {RigFormat::kVins, "vins"}}};
}

/// A calibration in the format of a program; numbers are exact, values that the format does not have are in
/// comments. `kStillpoint` is `rig_file_text`. One file contains camera and IMU, with the keys of:
/// - Kalibr: cam0 and imu0; T_cam_imu takes the IMU to the camera (T_c_b); axes as the model
/// scale-misalignment.
///   OpenVINS: the same with T_imu_cam (T_b_c), without axes.
/// - OpenCV: camera_matrix and distortion_coefficients of the camera alone.
/// - ORB-SLAM3: Camera1.fx ..., IMU.T_b_c1, noise densities, RGBD.DepthMapFactor.
/// - VINS: projection_parameters, body_T_cam0 (VINS-Fusion) and extrinsicRotation, extrinsicTranslation
///   (VINS-Mono), td. Its noises are those of a sample at its rate, which a Rig does not contain.
/// @throws InputError if the format has no distortion model like that of the camera
[[nodiscard]] std::string rig_text(const Rig& rig, RigFormat format);

}  // namespace stillpoint::datasets
