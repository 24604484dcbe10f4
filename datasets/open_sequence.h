// SPDX-License-Identifier: BSD-3-Clause
/// Opens a sequence folder or bag of any supported format.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/cache/frame_cache_options.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::datasets {

/// How to open a folder; empty fields are detected automatically.
struct OpenOptions {
  std::string format;               ///< one of `sequence_format_names`
  std::string id;                   ///< identity of the content if the caller knows it
  std::filesystem::path rig_file;   ///< a rig.toml that overrides the calibration of the format
  std::vector<std::string> topics;  ///< of a bag: "ROLE=TOPIC", see `select_topics`
  bool raw_depth = false;           ///< do not register depth images of another camera; without a frame cache
  bool defer_color = false;         ///< decode color images only when they are used, see `color_image`
  std::optional<FrameCacheOptions> frame_cache;  ///< keep decoded frames on disk
};

/// Opens a sequence folder or a bag; its format is detected from the files in it.
/// @throws InputError if the folder is not a sequence, or a text file in it is unreadable, unsorted or has
/// values that are not finite
[[nodiscard]] std::unique_ptr<SensorStream> open_sequence(const std::filesystem::path& folder,
                                                          const OpenOptions& options = {});

/// Whether `open_sequence` may read the path: a folder, or an existing bag.
[[nodiscard]] bool is_sequence_path(const std::filesystem::path& path);

/// A file of the user in a sequence folder, or beside a bag that is one file: FILE.rig.toml for FILE.bag.
[[nodiscard]] std::filesystem::path companion_file(const std::filesystem::path& sequence,
                                                   const std::string& name);

/// The names of all sequence formats for messages and help texts, e.g. "tum, openloris, euroc".
[[nodiscard]] std::string sequence_format_names();

}  // namespace stillpoint::datasets
