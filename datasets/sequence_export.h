// SPDX-License-Identifier: BSD-3-Clause
/// Exports a sequence of any format in the TUM RGB-D or EuRoC layout.
#pragma once

#include <filesystem>

#include "datasets/sensor_stream.h"

namespace stillpoint::datasets {

/// TUM RGB-D: rgb/ and depth/ with their lists, groundtruth.txt (camera in world), imu.txt (`t wx wy wz ax ay
/// az`) if there is an IMU, rig.toml with the calibration. Frames without color are written as gray images.
/// @param stream every frame is decoded
/// @param folder created atomically: it exists only once it is complete
/// @throws InputError if it cannot be written, or an image cannot be read
void export_tum(const SensorStream& stream, const std::filesystem::path& folder);

/// EuRoC ASL: mav0/cam0 (gray), mav0/imu0, mav0/state_groundtruth_estimate0 (pose of the IMU in the world;
/// velocity and biases are written as 0).
/// @throws InputError as above, and if there is no IMU
void export_euroc(const SensorStream& stream, const std::filesystem::path& folder);

}  // namespace stillpoint::datasets
