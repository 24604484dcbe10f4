// SPDX-License-Identifier: BSD-3-Clause
/// Exports a sequence of any format in the TUM RGB-D or EuRoC layout, or as a bag.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "datasets/sensor_stream.h"

namespace stillpoint::datasets {

/// Progress and interruption of an export; both functions may be empty.
struct ExportControl {
  std::function<void(std::size_t done, std::size_t total)> progress;  ///< called after each frame
  std::function<bool()> stop_requested;  ///< then the export ends with an InputError, without output
};

/// TUM RGB-D: rgb/ and depth/ with their lists, groundtruth.txt (camera in world), imu.txt (`t wx wy wz ax ay
/// az`) if there is an IMU, rig.toml with the calibration. Frames without color are written as gray images.
/// @param stream every frame is decoded
/// @param folder created atomically: it exists only once it is complete
/// @param control progress and interruption
/// @throws InputError if it cannot be written, or an image cannot be read
void export_tum(const SensorStream& stream, const std::filesystem::path& folder,
                const ExportControl& control = {});

/// EuRoC ASL: mav0/cam0 (gray), mav0/imu0, mav0/state_groundtruth_estimate0 (pose of the IMU in the world;
/// velocity and biases are written as 0), and rig.toml with time offset and readout time, which these files
/// do not have.
/// @throws InputError as above, and if there is no IMU
void export_euroc(const SensorStream& stream, const std::filesystem::path& folder,
                  const ExportControl& control = {});

/// A bag with the topics of realsense-ros: /camera/color/image_raw,
/// /camera/aligned_depth_to_color/image_raw, each with camera_info, /camera/imu, /tf_static, and
/// /ground_truth (TransformStamped, camera in world). Depth with 1000 units per meter is written as 16UC1,
/// other depth as 32FC1 in meters. What a bag cannot contain is written beside it, where `open_sequence`
/// finds it: noise densities, time offset and readout time to rig.toml, recorded boxes to detections.txt. The
/// bits of images (depth of 1000 or 5000 units per meter), inertial samples and the calibration are kept;
/// depth of other units is rounded to 0.2 mm.
/// @param stream every frame is decoded
/// @param path FILE.bag for ROS 1, FILE.mcap, or the folder of a rosbag2 with an SQLite database; must not
/// exist
/// @param compression of the chunks: none, bz2 or lz4 (ROS 1), none, lz4 or zstd (MCAP), none (rosbag2)
/// @param control progress and interruption
/// @throws InputError as above
void export_bag(const SensorStream& stream, const std::filesystem::path& path,
                const std::string& compression = "none", const ExportControl& control = {});

}  // namespace stillpoint::datasets
