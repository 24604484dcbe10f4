// SPDX-License-Identifier: BSD-3-Clause
/// Opens a sequence by folder, or by the name of a preset that is rendered on demand.
#pragma once

#include <memory>
#include <string>

#include "datasets/open_sequence.h"
#include "datasets/synthetic/sequence/render_sequence.h"

namespace stillpoint::bench {

/// Opens a folder, or a preset with its default settings; a preset is rendered unless it is in the cache.
/// @param name    path of a sequence folder, or a preset, e.g. "walking_xyz"
/// @param control of the rendering, if one is necessary
/// @return null if the rendering was stopped
/// @throws InputError if the name is neither, and errors of opening and rendering
[[nodiscard]] std::unique_ptr<datasets::SensorStream> find_sequence(const std::string& name,
                                                                    const datasets::OpenOptions& options,
                                                                    const synth::RenderControl& control);

}  // namespace stillpoint::bench
