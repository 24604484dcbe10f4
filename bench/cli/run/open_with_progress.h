// SPDX-License-Identifier: BSD-3-Clause
/// Opens the sequence of a run.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "datasets/open_sequence.h"

namespace stillpoint::bench {

/// `find_sequence` with a progress line while a preset is rendered.
/// @return null if interrupted
[[nodiscard]] std::unique_ptr<datasets::SensorStream> open_with_progress(
    const std::string& name, const datasets::OpenOptions& options);

/// Options of the frame cache whose warnings are logged.
/// @param max_frames 0 = all
/// @return nullopt unless `enabled`, or as `frame_cache_options`
[[nodiscard]] std::optional<datasets::FrameCacheOptions> logged_frame_cache(bool enabled, int max_frames);

}  // namespace stillpoint::bench
