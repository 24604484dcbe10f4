// SPDX-License-Identifier: BSD-3-Clause
/// Errors of the calibration that the odometry is told, and a draw of all imperfections of one rig.
#pragma once

#include <vector>

#include "core/types/rig.h"
#include "datasets/faults/sensor_fault.h"

namespace stillpoint::datasets {

/// The calibration that is stated instead of `rig`, with a fault of target `kCalibration` but `kRig`. The
/// data is not changed. With a: amount, u: random unit vector of the seed:
///
///   focal_error        (fx, fy) <- (1 + a / 100) (fx, fy)
///   center_error       (cx, cy) <- (cx, cy) + a u
///   distortion_error   k1 <- k1 - a: if k1 = 0 is stated for a lens with k1 = a, the error is the same to
///   first
///                      order
///   rotation_error     R_b_c <- R_b_c Exp(a u)
///   lever_error        p_b_c <- p_b_c + a u
///
/// @param rig with an IMU for the last two
[[nodiscard]] Rig rig_with_fault(Rig rig, const SensorFault& fault);

/// Replaces each fault of the kind `kRig` by single imperfections of a consumer rig, drawn by its seed; the
/// others are returned as they are. With m: amount of the fault (ratio of the magnitudes), N(s): normal with
/// standard deviation m s, U(l, h): uniform in [m l, m h], sorted by origin:
///
///   calibration   focal_error N(1 %), center_error |N(3 px)|, distortion_error N(0.02), rotation_error
///                 |N(1 deg)|, lever_error |N(1 cm)|: origins in sensor_fault.h
///   depth         depth_scaled 1 + N(0.02), in one of ten rigs 1 - U(0.05, 0.1): factors of 1.031 and 1.035
///                 (TUM RGB-D, fr1 and fr2), OpenLORIS 10-22 % short; depth_bias N(0.003/m), depth_noise
///                 U(0.001, 0.004)/m, depth_shift |N(2 px)|
///   images        exposure_steps U(0.1, 0.5) stops, vignetting U(0.1, 0.4), exposure_blur U(5, 15) ms, jpeg
///                 with a quality of 100 - U(5, 25), dropped U(0, 0.05): the fr3 sequences of TUM lack 4-6 %
///                 of their frames
///   IMU           time_offset N(5 ms) (Qin and Shen 2018), clock_drift N(20 ppm), imu_noise 1 + U(1, 3),
///                 gyro_scale U(0.2, 0.8) %, accel_scale U(0.5, 1) %, imu_misalignment U(0.1, 0.5) deg,
///                 g_sensitivity U(0, 0.1) (deg/s)/g, imu_vibration U(0, 0.3) m/s^2
///
/// Amounts are rounded to four digits and limited to the range of their kind.
[[nodiscard]] std::vector<SensorFault> expanded_rigs(const std::vector<SensorFault>& faults);

}  // namespace stillpoint::datasets
