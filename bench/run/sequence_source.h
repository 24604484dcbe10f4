// SPDX-License-Identifier: BSD-3-Clause
/// Opens a sequence by folder, or by the name of a preset, which is rendered on demand into the sequence
/// cache and the frame cache.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "datasets/cache/frame_cache_options.h"
#include "datasets/open_sequence.h"
#include "datasets/synthetic/sequence/render_sequence.h"

namespace stillpoint::bench {

/// `synth::cached_sequence`; if the sequence is rendered now, its frames are written to the frame cache, too.
/// @param control without `on_images`
/// @return an empty path if stopped by `control`
/// @throws InputError as `synth::cached_sequence`
[[nodiscard]] std::filesystem::path rendered_sequence(
    const synth::SynthRequest& request, synth::RenderControl control,
    const std::optional<datasets::FrameCacheOptions>& frame_cache);

/// Opens a folder, or a preset with its default settings; a preset is rendered unless it is in the cache.
/// @param name    path of a sequence folder, or a preset, e.g. "walking_xyz"
/// @param control of the rendering, if one is necessary
/// @return null if the rendering was stopped
/// @throws InputError if the name is neither, and errors of opening and rendering
[[nodiscard]] std::unique_ptr<datasets::SensorStream> find_sequence(const std::string& name,
                                                                    const datasets::OpenOptions& options,
                                                                    const synth::RenderControl& control);

}  // namespace stillpoint::bench
