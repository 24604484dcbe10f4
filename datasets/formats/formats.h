// SPDX-License-Identifier: BSD-3-Clause
/// The layouts of sequence folders that we read, in the order in which a folder is tried against them.
#pragma once

#include <span>

#include "datasets/sequence_content.h"

namespace stillpoint {

/// TUM RGB-D: rgb.txt, depth.txt, groundtruth.txt; optionally imu.txt (`t wx wy wz ax ay az`, t in seconds)
/// or imu.csv (the same with t in ns), for which rig.toml must say where the IMU sits.
extern const SequenceFormat kTumFormat;

/// OpenLORIS-Scene package of the D435i: colour, aligned depth, gyroscope and accelerometer apart.
extern const SequenceFormat kOpenLorisFormat;

/// EuRoC ASL: left camera and IMU; no depth.
extern const SequenceFormat kEurocFormat;

/// Microsoft 7-Scenes: numbered frames with a pose each, no time stamps.
extern const SequenceFormat kSevenScenesFormat;

/// Bare folders color/ and depth/ with pictures of equal names; calibration from a JSON file or rig.toml.
extern const SequenceFormat kFolderFormat;

[[nodiscard]] std::span<const SequenceFormat* const> sequence_formats();

}  // namespace stillpoint
