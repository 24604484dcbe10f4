// SPDX-License-Identifier: BSD-3-Clause
/// Writes any sequence in a layout that other programs read.
#pragma once

#include <filesystem>

#include "datasets/sensor_stream.h"

namespace stillpoint {

/// TUM RGB-D: rgb/ and depth/ with their lists, groundtruth.txt (camera in world), imu.txt (`t wx wy wz ax ay
/// az`) where there is an IMU, rig.toml with the calibration. A grey picture stands in where there is no
/// colour.
/// @param folder appears only when it is complete
/// @throws InputError if it cannot be written, or a picture cannot be read
void export_tum(const SensorStream& stream, const std::filesystem::path& folder);

/// EuRoC ASL: mav0/cam0 (grey), mav0/imu0, mav0/state_groundtruth_estimate0 (IMU in world; velocity and
/// biases 0).
/// @throws InputError as above, and if there is no IMU
void export_euroc(const SensorStream& stream, const std::filesystem::path& folder);

}  // namespace stillpoint
