// SPDX-License-Identifier: BSD-3-Clause
/// Finds the sequence that a user names: a folder, or a rendered one that is made on demand.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "datasets/sensor_stream.h"

namespace stillpoint {

/// A sequence that the program renders itself.
struct RenderRequest {
  std::string preset;
  double seconds = 20.0;
  int seed = 1;
};

/// The folder of a rendered sequence, taken from the cache or made now.
/// @throws InputError for an unknown preset, and if the cache cannot be written
[[nodiscard]] std::filesystem::path rendered_folder(const RenderRequest& request);

/// @param name path of a sequence folder, or a preset, e.g. "walking_xyz"
/// @throws InputError if it is neither, and what `open_sequence` throws
[[nodiscard]] std::unique_ptr<SensorStream> find_sequence(const std::string& name,
                                                          const OpenOptions& options);

}  // namespace stillpoint
