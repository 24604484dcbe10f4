// SPDX-License-Identifier: BSD-3-Clause
/// Calibration of the sensors on one robot.
#pragma once

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "core/types/imu_sample.h"

namespace stillpoint {

struct Rig {
  Camera camera;
  double depth_units_per_m = 1000.0;  ///< raw depth value of one metre
  bool has_imu = false;
  Pose T_b_c;  ///< camera to body; identity without an IMU
  ImuNoise imu_noise;
  double time_offset_s = 0.0;      ///< IMU time of an exposure minus the picture's stamp
  double rolling_shutter_s = 0.0;  ///< read-out time from the first to the last row; 0 = global shutter
};

}  // namespace stillpoint
