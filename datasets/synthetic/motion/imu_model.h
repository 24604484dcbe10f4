// SPDX-License-Identifier: BSD-3-Clause
/// IMU measurement model on a smooth path.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/timestamp.h"
#include "core/types/rig.h"
#include "datasets/io/imu_file.h"
#include "datasets/synthetic/motion/path_spline.h"

namespace stillpoint::synth {

/// White noise and random-walk bias (IEEE Std 952; Woodman 2007). With the sample interval dt,
///
///   z_k = x_k + b_k + density / sqrt(dt) * n_k,   b_{k+1} = b_k + walk * sqrt(dt) * m_k,   n, m ~ N(0, I)
///
/// x: true angular rate or specific force. The default densities are those of the OpenLORIS packages for a
/// RealSense D435i (Bosch BMI055).
struct ImuSensor {
  double gyro_rate_hz = 400.0;
  double accel_rate_hz = 250.0;
  ImuNoise noise{.gyro_noise = 1.8e-4, .accel_noise = 2.5e-3, .gyro_walk = 2e-5, .accel_walk = 2e-4};
  double gyro_bias = 0.003;    ///< standard deviation per axis of the initial bias [rad/s]
  double accel_bias = 0.03;    ///< the same for the accelerometer [m/s^2]
  double time_offset_s = 0.0;  ///< IMU timestamp minus true time
};

struct ImuRecord {
  std::vector<datasets::VectorSample> gyro;   ///< [rad/s]
  std::vector<datasets::VectorSample> accel;  ///< [m/s^2]
};

struct ImuInterval {
  Timestamp epoch;      ///< timestamp of path time 0
  double from_s = 0.0;  ///< in path time
  double to_s = 0.0;
  std::uint64_t seed = 1;
};

/// Samples over an interval; gyroscope and accelerometer have separate rates and phases.
[[nodiscard]] ImuRecord simulate_imu(const PathSpline& path, const ImuSensor& sensor,
                                     const ImuInterval& interval);

}  // namespace stillpoint::synth
