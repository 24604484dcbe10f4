// SPDX-License-Identifier: BSD-3-Clause
/// Calibrations that other programs write as YAML.
#pragma once

#include <filesystem>

#include "datasets/calibration/rig_file.h"

namespace stillpoint::datasets {

/// Replaces the values of `rig` that the file contains. It is read by its keys; one file may have those of
/// several of these, e.g. camchain and imu.yaml of Kalibr one after the other:
/// - Kalibr: cam0 with intrinsics, distortion, T_cam_imu (IMU to camera, the inverse of T_b_c; or T_imu_cam,
/// as
///   OpenVINS writes it) and timeshift_cam_imu (IMU time minus camera time, as `Rig::time_offset_s`); imu0 or
///   the file itself with noise densities, and of the model scale-misalignment the axes: those of the
///   accelerometer are M, of the gyroscope M C_gyro_i; those of OpenVINS are Ta R_IMUtoACC and Tw
///   R_IMUtoGYRO. A or Tg, the influence of accelerations on the gyroscope, is not read. EuRoC: sensor.yaml
///   of a camera, whose body is the IMU, or of an IMU.
/// - OpenCV and CameraInfo of ROS: camera_matrix, distortion_coefficients, image_width, image_height; or K,
/// D,
///   width, height.
/// - ORB-SLAM: Camera.fx or Camera1.fx ..., IMU.T_b_c1 or Tbc, IMU.NoiseGyro ..., RGBD.DepthMapFactor.
/// - VINS: projection_parameters, distortion_parameters, extrinsicRotation and extrinsicTranslation or
///   body_T_cam0 (camera to IMU), td. Its noises are those of a sample at an unknown rate, and are not read.
/// Files that are named by cam0_calib (VINS-Fusion), relative_config_imu or relative_config_imucam (OpenVINS)
/// are read, too.
/// @throws InputError with file and key on a value that is missing, out of range or contradicts another one,
/// a camera model that `Camera` does not have, or a file without any of these keys
[[nodiscard]] OverriddenRig apply_rig_yaml(const std::filesystem::path& file, const Rig& rig);

}  // namespace stillpoint::datasets
