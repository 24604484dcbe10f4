// SPDX-License-Identifier: BSD-3-Clause
/// Registry of the supported sequence formats. A new format is one file in this folder, which defines a
/// `SequenceFormat`, and its declaration and entry in the list below.
#pragma once

#include <array>
#include <filesystem>
#include <string_view>

#include "core/base/fault_log.h"
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

/// Plain folders color/ and depth/ with images of equal names; calibration from a JSON file or rig.toml.
extern const SequenceFormat kFolderFormat;

/// All formats, in the order of detection.
inline constexpr std::array kSequenceFormats{&kTumFormat, &kOpenLorisFormat, &kEurocFormat,
                                             &kSevenScenesFormat, &kFolderFormat};

}  // namespace stillpoint::datasets
