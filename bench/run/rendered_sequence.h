// SPDX-License-Identifier: BSD-3-Clause
/// Renders a sequence into the sequence cache and the frame cache.
#pragma once

#include <filesystem>
#include <optional>

#include "datasets/cache/frame_cache_options.h"
#include "datasets/synthetic/sequence/render_sequence.h"

namespace stillpoint::bench {

/// `synth::cached_sequence`; if the sequence is rendered now, its frames are written to the frame cache, too.
/// @param control without `on_images`
/// @return an empty path if stopped by `control`
/// @throws InputError as `synth::cached_sequence`
[[nodiscard]] std::filesystem::path rendered_sequence(
    const synth::SynthRequest& request, synth::RenderControl control,
    const std::optional<datasets::FrameCacheOptions>& frame_cache);

}  // namespace stillpoint::bench
