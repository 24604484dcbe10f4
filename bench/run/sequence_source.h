// SPDX-License-Identifier: BSD-3-Clause
/// Finds the sequence that a user names: a folder, or a rendered one that is made on demand.
#pragma once

#include <memory>
#include <string>

#include "datasets/sensor_stream.h"
#include "datasets/synthetic/render_sequence.h"

namespace stillpoint {

/// Opens a folder, or a preset's rendering with its default settings, from the cache or made now.
/// @param name    path of a sequence folder, or a preset, e.g. "walking_xyz"
/// @param control of the rendering, if there is one
/// @return nothing if the rendering was stopped
/// @throws InputError if the name is neither, and what opening and rendering throw
[[nodiscard]] std::unique_ptr<SensorStream> find_sequence(const std::string& name, const OpenOptions& options,
                                                          const RenderControl& control);

}  // namespace stillpoint
