// SPDX-License-Identifier: BSD-3-Clause
/// What an inertial sensor on a smooth path measures.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/timestamp.h"
#include "core/types/imu_sample.h"
#include "datasets/imu_file.h"
#include "datasets/synthetic/path_spline.h"

namespace stillpoint {

/// White noise and a bias that walks at random (IEEE Std 952; Woodman 2007). The densities' defaults are
/// those that the OpenLORIS packages state for a RealSense D435i (Bosch BMI055).
struct ImuSensor {
  double gyro_rate_hz = 400.0;
  double accel_rate_hz = 250.0;
  ImuNoise noise{.gyro_noise = 1.8e-4, .accel_noise = 2.5e-3, .gyro_walk = 2e-5, .accel_walk = 2e-4};
  double gyro_bias = 0.003;    ///< standard deviation of each axis at the start [rad/s]
  double accel_bias = 0.03;    ///< same [m/s^2]
  double time_offset_s = 0.0;  ///< IMU stamp minus true time
};

struct InertialRecord {
  std::vector<VectorSample> gyro;   ///< [rad/s]
  std::vector<VectorSample> accel;  ///< [m/s^2]
};

/// Readings over [from_s, to_s] of the path's time, at the sensors' own rates and phases.
/// @param epoch stamp of path time 0
[[nodiscard]] InertialRecord measure_inertia(const PathSpline& path, const ImuSensor& sensor, Timestamp epoch,
                                             double from_s, double to_s, std::uint64_t seed);

}  // namespace stillpoint
