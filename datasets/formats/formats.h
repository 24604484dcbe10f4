// SPDX-License-Identifier: BSD-3-Clause
/// Registry of the supported sequence formats. A new format is one file in this folder, which defines a
/// `SequenceFormat`, and its declaration and entry in the list below.
#pragma once

#include <array>
#include <filesystem>
#include <string_view>

#include "core/base/error.h"
#include "datasets/formats/sequence_content.h"

namespace stillpoint::datasets {

/// Reader of one sequence folder layout.
struct SequenceFormat {
  std::string_view name;       ///< in options, messages and `SequenceInfo::format`
  std::string_view signature;  ///< files by which it is recognized, for messages
  bool (*recognize)(const std::filesystem::path& folder);
  SequenceContent (*read)(const std::filesystem::path& folder, FaultLog& faults);
};

/// TUM RGB-D: rgb.txt, depth.txt, groundtruth.txt; optionally imu.txt (`t wx wy wz ax ay az`, t in seconds)
/// or imu.csv (the same with t in ns), which require the extrinsic T_b_c in rig.toml.
extern const SequenceFormat kTumFormat;

/// OpenLORIS-Scene package of the D435i: color, aligned depth, separate gyroscope and accelerometer files.
extern const SequenceFormat kOpenLorisFormat;

/// EuRoC ASL: left camera and IMU; no depth.
extern const SequenceFormat kEurocFormat;

/// Microsoft 7-Scenes: numbered frames with one pose each, no timestamps.
extern const SequenceFormat kSevenScenesFormat;

/// Bags of ROS 1 (.bag) and ROS 2 (.mcap, .db3, folders of rosbag2), and recordings of librealsense.
extern const SequenceFormat kBagFormat;

/// ETH3D SLAM: lists like TUM RGB-D, calibration.txt; with or without depth.
extern const SequenceFormat kEth3dFormat;

/// ICL-NUIM in the layout of TUM RGB-D: associations.txt with frame numbers, published with fy < 0.
extern const SequenceFormat kIclNuimFormat;

/// TUM VI, exported in EuRoC format: left fisheye camera and IMU; no depth.
extern const SequenceFormat kTumViFormat;

/// CID-SIMS: images named by time, imu.txt, pose.txt; the camera must be given in rig.toml.
extern const SequenceFormat kCidSimsFormat;

/// Plain folders color/ and depth/ with images of equal names; calibration from a JSON file or rig.toml.
extern const SequenceFormat kFolderFormat;

/// All formats, in the order of detection.
inline constexpr std::array kSequenceFormats{
    &kBagFormat,   &kEth3dFormat, &kTumFormat,         &kIclNuimFormat, &kOpenLorisFormat,
    &kTumViFormat, &kEurocFormat, &kSevenScenesFormat, &kCidSimsFormat, &kFolderFormat};

}  // namespace stillpoint::datasets
