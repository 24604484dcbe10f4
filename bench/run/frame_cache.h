// SPDX-License-Identifier: BSD-3-Clause
/// The frame cache of this user: where it is, how large it may become, and how a sequence is decoded into it
/// ahead of runs whose time is measured.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "datasets/cache/frame_cache_options.h"

namespace stillpoint::bench {

/// Folder `frames` in the cache folder, see `datasets::cache_folder`.
/// @throws InputError if no variable determines a folder
[[nodiscard]] std::filesystem::path frame_cache_folder();

/// Folder of remembered checksums of sequences; empty if no variable determines a folder.
[[nodiscard]] std::filesystem::path checksum_folder();

/// $STILLPOINT_CACHE_SIZE, else the limit stored in the folder, else the default [bytes]. 0 = no frame cache.
/// @throws InputError if either is not a size
[[nodiscard]] std::uint64_t frame_cache_limit(const std::filesystem::path& folder);

/// Stores the limit in the folder, which is created if it is missing.
/// @throws InputError if it cannot be written
void store_frame_cache_limit(const std::filesystem::path& folder, std::uint64_t bytes);

/// Options for a run of the first `max_frames` frames (0 = all).
/// @return nullopt if the limit is 0, or there is no folder for the cache
/// @throws InputError as `frame_cache_limit`
[[nodiscard]] std::optional<datasets::FrameCacheOptions> frame_cache_options(
    std::size_t max_frames, const std::function<void(const std::string& text)>& warn);

/// Decodes the images of a sequence into the frame cache unless they are there, and reads the cached images,
/// so that the system holds them in memory. Images that cannot be decoded are left to the run, which reports
/// them.
/// @param max_frames from the start of the sequence; 0 = all
/// @param stop_requested polled before each frame; may be empty
/// @throws InputError if the sequence cannot be opened
void fill_frame_cache(const std::filesystem::path& folder, int max_frames,
                      const std::function<bool()>& stop_requested);

}  // namespace stillpoint::bench
