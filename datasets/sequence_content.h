// SPDX-License-Identifier: BSD-3-Clause
/// What the reader of a format finds in a folder: the facts of the sequence, and the files of its pictures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/depth_registration.h"
#include "datasets/fault_log.h"
#include "datasets/sensor_stream.h"

namespace stillpoint {

struct PictureFiles {
  std::filesystem::path color;
  std::filesystem::path depth;  ///< empty when the sequence has no depth
  double depth_offset_s = 0.0;  ///< stamp of the depth picture minus that of the colour picture
};

struct SequenceContent {
  SequenceInfo info;
  std::vector<PictureFiles> pictures;       ///< one per info.frame_times
  bool extrinsic_known = true;              ///< whether the format says where the IMU sits
  std::string calibration_assumed;          ///< what to tell the user when no rig file replaces a guess
  std::uint16_t no_depth_value = 0;         ///< a second raw value that means "not measured"
  std::optional<DepthCamera> depth_camera;  ///< set when depth is of another camera and must be registered
};

/// One layout of sequence folders.
struct SequenceFormat {
  std::string_view name;
  std::string_view mark;  ///< how it is recognised, for messages
  bool (*recognise)(const std::filesystem::path& folder);
  SequenceContent (*read)(const std::filesystem::path& folder, FaultLog& faults);
};

/// Reads all text files of a folder and applies the rig file.
/// @throws InputError as `open_sequence`; in a collecting log, faulty rows are kept there and left out
/// instead
[[nodiscard]] SequenceContent read_sequence(const std::filesystem::path& folder, const OpenOptions& options,
                                            FaultLog& faults);

/// Decodes frame `index`; see `SensorStream::load_frame`.
[[nodiscard]] Frame decode_frame(const SequenceContent& content, std::size_t index);

}  // namespace stillpoint
