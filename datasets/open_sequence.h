// SPDX-License-Identifier: BSD-3-Clause
/// Opens a sequence folder of any supported format.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "datasets/cache/frame_cache_options.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::datasets {

/// How to open a folder; empty fields are detected automatically.
struct OpenOptions {
  std::string format;              ///< one of `sequence_format_names`
  std::filesystem::path rig_file;  ///< a rig.toml that overrides the calibration of the format
  bool defer_color = false;        ///< decode color images only when they are used, see `color_image`
  std::optional<FrameCacheOptions> frame_cache;  ///< keep decoded frames on disk
};

/// Opens a sequence folder; its format is detected from the files in it.
/// @throws InputError if the folder is not a sequence, or a text file in it is unreadable, unsorted or has
/// values that are not finite
[[nodiscard]] std::unique_ptr<SensorStream> open_sequence(const std::filesystem::path& folder,
                                                          const OpenOptions& options = {});

/// The names of all sequence formats for messages and help texts, e.g. "tum, openloris, euroc".
[[nodiscard]] std::string sequence_format_names();

}  // namespace stillpoint::datasets
