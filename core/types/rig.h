// SPDX-License-Identifier: BSD-3-Clause
/// Sensor calibration of one robot.
#pragma once

#include "core/geometry/camera.h"
#include "core/geometry/pose.h"
#include "core/types/imu_sample.h"

namespace stillpoint {

struct Rig {
  Camera camera;
  double depth_units_per_m = 1000.0;  ///< raw depth value corresponding to 1 m
  bool has_imu = false;
  Pose T_b_c;  ///< camera to body; identity if there is no IMU
  ImuNoise imu_noise;
  double time_offset_s = 0.0;      ///< IMU time of an exposure minus the timestamp of its image
  double rolling_shutter_s = 0.0;  ///< readout time from the first to the last row; 0 = global shutter
};

/// Calibration to be estimated that has the value of the rig as long as the data does not contradict it:
/// constant in the solve, but with its uncertainty in prior and covariance.
struct AgreesWithRig {
  bool extrinsics = false;
  bool depth_scale = false;

  [[nodiscard]] bool any() const { return extrinsics || depth_scale; }
};

}  // namespace stillpoint
