// SPDX-License-Identifier: BSD-3-Clause
/// Decodes a sequence ahead of runs whose time is measured.
#pragma once

#include <filesystem>
#include <functional>

namespace stillpoint::bench {

/// Decodes the images of a sequence into the frame cache unless they are there, and reads the cached images,
/// so that the system holds them in memory. Images that cannot be decoded are left to the run, which reports
/// them.
/// @param max_frames from the start of the sequence; 0 = all
/// @param stop_requested polled before each frame; may be empty
/// @throws InputError if the sequence cannot be opened
void fill_frame_cache(const std::filesystem::path& folder, int max_frames,
                      const std::function<bool()>& stop_requested);

}  // namespace stillpoint::bench
