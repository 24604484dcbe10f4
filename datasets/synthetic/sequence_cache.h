// SPDX-License-Identifier: BSD-3-Clause
/// Rendered sequences are kept, so that each is rendered once.
#pragma once

#include <filesystem>

#include "datasets/synthetic/render_sequence.h"

namespace stillpoint {

/// $STILLPOINT_CACHE, else $XDG_CACHE_HOME/stillpoint, else ~/.cache/stillpoint.
/// @throws InputError if none of the three variables (the last: HOME) is set
[[nodiscard]] std::filesystem::path cache_folder();

/// Folder of the sequence, rendered now if it is not in the cache. Several processes may ask at once.
/// @return an empty path if `control` asked to stop
/// @throws InputError as `render_sequence`, and if the cache cannot be written
[[nodiscard]] std::filesystem::path cached_sequence(const SynthRequest& request,
                                                    const RenderControl& control = {});

}  // namespace stillpoint
