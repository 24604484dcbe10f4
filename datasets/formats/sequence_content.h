// SPDX-License-Identifier: BSD-3-Clause
/// Result of a format reader: the metadata of the sequence and the paths of its image files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/calibration/depth_registration.h"
#include "datasets/io/sequence_info.h"

namespace stillpoint::datasets {

struct FrameFiles {
  std::filesystem::path color;
  std::filesystem::path depth;  ///< empty when the sequence has no depth
  double depth_offset_s = 0.0;  ///< timestamp of the depth image minus that of the color image
};

struct SequenceContent {
  SequenceInfo info;
  std::vector<FrameFiles> frame_files;   ///< one per info.frame_times
  bool extrinsic_known = true;           ///< whether the format provides the camera-IMU extrinsic
  std::string assumed_calibration_note;  ///< note for the user if no rig file replaces a default calibration
  std::uint16_t no_depth_value = 0;      ///< raw value, besides 0, that means "not measured"
  std::optional<DepthCamera> depth_camera;  ///< set if depth is not yet registered to the color camera
};

}  // namespace stillpoint::datasets
