// SPDX-License-Identifier: BSD-3-Clause
/// Disk space of the frame cache: its files, their limit, and the removal of those that were not used for
/// longest.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "datasets/cache/frame_cache_options.h"

namespace stillpoint::datasets {

/// Folder of everything that is kept between runs: $STILLPOINT_CACHE, else $XDG_CACHE_HOME/stillpoint, else
/// ~/.cache/stillpoint.
/// @throws InputError if none of the three variables (the last: HOME) is set
[[nodiscard]] std::filesystem::path cache_folder();

/// A complete file of the cache.
struct CacheEntry {
  std::filesystem::path file;
  std::string sequence;  ///< name; empty if the file is damaged
  std::size_t frames = 0;
  std::uint64_t bytes = 0;
  std::filesystem::file_time_type last_used;
};

/// The complete files, the least recently used first. Empty if the folder does not exist.
[[nodiscard]] std::vector<CacheEntry> list_cache(const std::filesystem::path& folder);

/// Size of all files, including those that are being written [bytes].
[[nodiscard]] std::uint64_t cache_bytes(const std::filesystem::path& folder);

/// Removes the least recently used files until all files together have at most `max_bytes`, files of killed
/// writers, and the digests of folders that no longer exist. Processes that have a removed file open can
/// still read it.
/// @return number of removed bytes
std::uint64_t prune_cache(const std::filesystem::path& folder, std::uint64_t max_bytes);

/// Makes room for one file while it is written.
class CacheSpace {
 public:
  explicit CacheSpace(const FrameCacheOptions& options);

  /// Announces the expected size of the whole file, and removes other files if that is necessary.
  /// @throws InputError if the file cannot fit; no file was removed then
  void expect(std::uint64_t bytes);

  /// Call before each write.
  /// @throws InputError if the limit or the reserve of the disk would be exceeded
  void require(std::uint64_t bytes);

 private:
  void make_room(std::uint64_t bytes) const;

  std::filesystem::path folder_;
  std::uint64_t max_bytes_;
  std::uint64_t disk_reserve_bytes_;
  std::uint64_t granted_bytes_ = 0;  ///< of the file
  std::uint64_t used_bytes_ = 0;     ///< of the file
};

/// Bytes from text, e.g. "500M", "20G" or "20 GB": decimal multiples; a plain number is in bytes.
/// @param place for the error, e.g. the name of the option
/// @throws InputError if the text is not a size
[[nodiscard]] std::uint64_t size_from_text(const std::string& place, const std::string& text);

/// E.g. "1.2 GB".
[[nodiscard]] std::string size_text(std::uint64_t bytes);

}  // namespace stillpoint::datasets
