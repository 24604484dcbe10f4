// SPDX-License-Identifier: BSD-3-Clause
/// Faults of inertial data: functions from samples to samples.
#pragma once

#include <vector>

#include "core/types/rig.h"
#include "datasets/faults/sensor_fault.h"

namespace stillpoint::datasets {

/// Samples as the sensor would have delivered them with a fault of target `kImu`. Within the active interval:
///
///   imu_gap, imu_rate    samples are removed
///   gyro_saturated, accel_saturated    w <- clamp(w, -a, a),  f <- clamp(f, -a, a)  per axis
///   gyro_bias, accel_bias              w <- w + a (1, 1, 1),  f <- f + a (1, 1, 1)
///   shock                              f <- f + a u,  u: random unit vector, the same for each interval
///   imu_jitter, time_offset            t <- t + n, n ~ N(0, a^2);  t <- t + a
///
/// clock_jump shifts the stamps of all samples from its start on. a: amount. Samples whose shifted stamps
/// would not increase keep their order and are moved to 1 us after their predecessor.
/// @param samples in increasing order of time
/// @param start time of the first frame
[[nodiscard]] std::vector<ImuSample> samples_with_fault(std::vector<ImuSample> samples,
                                                        const SensorFault& fault, Timestamp start);

}  // namespace stillpoint::datasets
