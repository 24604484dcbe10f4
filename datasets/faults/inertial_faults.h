// SPDX-License-Identifier: BSD-3-Clause
/// Faults and imperfections of inertial samples.
///
/// Within the active interval, with a: amount, w: angular rate, f: specific force:
///
///   imu_gap, imu_rate    samples are removed
///   gyro_saturated, accel_saturated    w <- clamp(w, -a, a),  f <- clamp(f, -a, a)  per axis
///   gyro_bias, accel_bias              w <- w + a (1, 1, 1),  f <- f + a (1, 1, 1)
///   shock                              f <- f + a u,  u: random unit vector, the same for each interval
///   imu_jitter, time_offset            t <- t + n, n ~ N(0, a^2);  t <- t + a
///   clock_drift                        t <- t + 1e-6 a (t - t_start)
///   gyro_scale, accel_scale            x <- x + (a / 100) (s_x x_x, s_y x_y, s_z x_z),  s: random signs
///   imu_misalignment                   x <- (I + N) x,  N strictly upper triangular with entries +-a [rad],
///                                      another N for w and f (Tedaldi et al. 2014)
///   g_sensitivity                      w <- w + S f,  S = a / sqrt(3) times a matrix of random signs
///   imu_vibration                      f <- f + a u sin(p),  w <- w + (a / 15) v sin(p + q),
///                                      p = 2 pi nu (t - t_start);  u, v, nu, q random, nu in [40, 120] Hz
///   imu_noise                          x <- x + n d sqrt((a^2 - 1) / dt),  n ~ N(0, I),  d: stated density,
///                                      dt: time since the previous sample
///
/// clock_jump shifts the stamps of all samples from its start on. Samples whose shifted stamps would not
/// increase keep their order and are moved to 1 us after their predecessor.
#pragma once

#include <vector>

#include "core/base/timestamp.h"
#include "core/types/rig.h"
#include "datasets/faults/sensor_fault.h"

namespace stillpoint::datasets {

/// Samples as the sensor would have delivered them with a fault of target `kImu`.
/// @param samples in increasing order of time
/// @param start   time of the first frame
/// @param stated  densities of the calibration
[[nodiscard]] std::vector<ImuSample> samples_with_fault(std::vector<ImuSample> samples,
                                                        const SensorFault& fault, Timestamp start,
                                                        const ImuNoise& stated);

}  // namespace stillpoint::datasets
