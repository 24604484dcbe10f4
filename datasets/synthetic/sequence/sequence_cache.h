// SPDX-License-Identifier: BSD-3-Clause
/// On-disk cache of rendered sequences.
#pragma once

#include <filesystem>

#include "datasets/synthetic/sequence/render_sequence.h"

namespace stillpoint::synth {

/// $STILLPOINT_CACHE, else $XDG_CACHE_HOME/stillpoint, else ~/.cache/stillpoint.
/// @throws InputError if none of the three variables (the last: HOME) is set
[[nodiscard]] std::filesystem::path cache_folder();

/// Folder of the sequence; rendered first if it is not in the cache. Safe to call from several processes.
/// @return an empty path if stopped by `control`
/// @throws InputError as `render_sequence`, and if the cache cannot be written
[[nodiscard]] std::filesystem::path cached_sequence(const SynthRequest& request,
                                                    const RenderControl& control = {});

}  // namespace stillpoint::synth
