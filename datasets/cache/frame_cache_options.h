// SPDX-License-Identifier: BSD-3-Clause
/// Settings of the frame cache.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace stillpoint::datasets {

constexpr std::uint64_t kDefaultFrameCacheBytes = 20'000'000'000;
constexpr std::uint64_t kDefaultDiskReserveBytes = 2'000'000'000;

struct FrameCacheOptions {
  std::filesystem::path folder;                       ///< of all cache files; created if it is missing
  std::uint64_t max_bytes = kDefaultFrameCacheBytes;  ///< of all files; the least recently used are removed
  std::uint64_t disk_reserve_bytes = kDefaultDiskReserveBytes;  ///< of the disk, never used by the cache
  std::size_t max_frames = 0;  ///< frames that will be read, from the start of the sequence; 0 = all
  double max_seconds = 0.0;    ///< those earlier than this after the first one; 0 = all
  /// Receives problems as "LOCATION: FAULT", on the thread that loads a frame; may be empty.
  std::function<void(const std::string& text)> warn;
};

}  // namespace stillpoint::datasets
