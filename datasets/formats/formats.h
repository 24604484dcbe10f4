// SPDX-License-Identifier: BSD-3-Clause
/// The supported sequence formats, in the order of detection.
#pragma once

#include <span>

#include "datasets/sequence_content.h"

namespace stillpoint::datasets {

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

[[nodiscard]] std::span<const SequenceFormat* const> sequence_formats();

}  // namespace stillpoint::datasets
