// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/cache/cache_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <functional>
#include <numeric>
#include <optional>
#include <string_view>
#include <system_error>
#include <tuple>

#include "core/base/error.h"
#include "datasets/cache/cache_key.h"
#include "datasets/cache/frame_file.h"
#include "datasets/cache/user_folder.h"

namespace stillpoint::datasets {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kKilobyte = 1000;

std::uint64_t size_or_zero(const fs::path& file) {
  std::error_code error;  // the file may have been removed by another process
  const std::uintmax_t size = fs::file_size(file, error);
  return error ? 0 : size;
}

/// The complete files without their content, the least recently used first.
std::vector<CacheEntry> frame_files(const fs::path& folder) {
  std::vector<CacheEntry> entries;
  std::error_code error;
  for (const auto& file : fs::directory_iterator(folder, error)) {
    if (file.path().extension() != kFrameFileExtension) continue;
    entries.push_back({.file = file.path(),
                       .sequence = {},
                       .bytes = size_or_zero(file.path()),
                       .last_used = fs::last_write_time(file.path(), error)});
  }
  std::ranges::sort(entries, [](const CacheEntry& a, const CacheEntry& b) {
    return std::tie(a.last_used, a.file) < std::tie(b.last_used, b.file);
  });
  return entries;
}

/// Removes files from the start of the list until `bytes` are free. @return number of removed bytes
std::uint64_t remove_files(const std::vector<CacheEntry>& entries, std::uint64_t bytes) {
  std::uint64_t removed = 0;
  for (const CacheEntry& entry : entries) {
    if (removed >= bytes) break;
    std::error_code error;
    if (fs::remove(entry.file, error)) removed += entry.bytes;
  }
  return removed;
}

void remove_useless_digests(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path& file = entry.path();
    if (file.extension() == kUnfinishedExtension) fs::remove(file, error);
    if (file.extension() != kDigestsExtension) continue;
    const std::optional<fs::path> sequence = folder_of_digests(file);
    if (!sequence || !fs::is_directory(*sequence, error)) fs::remove(file, error);
  }
}

std::uint64_t available_bytes(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  return error ? 0 : space.available;
}

/// a - b, or 0.
std::uint64_t excess(std::uint64_t a, std::uint64_t b) { return a > b ? a - b : 0; }

}  // namespace

fs::path cache_folder() {
  if (fs::path own = variable_or_empty("STILLPOINT_CACHE"); !own.empty()) return own;
  if (fs::path users = user_folder("XDG_CACHE_HOME", ".cache"); !users.empty()) return users;
  throw InputError("STILLPOINT_CACHE",
                   "is not set, and neither is HOME; set it to the folder for rendered sequences");
}

std::vector<CacheEntry> list_cache(const fs::path& folder) {
  std::vector<CacheEntry> entries = frame_files(folder);
  for (CacheEntry& entry : entries) {
    try {
      const FrameFileReader reader(entry.file);
      entry.sequence = reader.info().sequence;
      entry.frames = reader.frames();
    } catch (const InputError&) {  // shown without a name; the next run of its sequence replaces it
    }
  }
  return entries;
}

std::uint64_t cache_bytes(const fs::path& folder) {
  std::uint64_t bytes = 0;
  std::error_code error;
  for (const auto& file : fs::directory_iterator(folder, error)) bytes += size_or_zero(file.path());
  return bytes;
}

std::uint64_t prune_cache(const fs::path& folder, std::uint64_t max_bytes) {
  const std::uint64_t before = cache_bytes(folder);
  remove_abandoned_files(folder);
  remove_useless_digests(folder);
  remove_files(frame_files(folder), excess(cache_bytes(folder), max_bytes));
  return excess(before, cache_bytes(folder));
}

CacheSpace::CacheSpace(const FrameCacheOptions& options)
    : folder_(options.folder),
      max_bytes_(options.max_bytes),
      disk_reserve_bytes_(options.disk_reserve_bytes) {}

void CacheSpace::make_room(std::uint64_t bytes) const {
  const std::vector<CacheEntry> entries = frame_files(folder_);
  const std::uint64_t removable =
      std::transform_reduce(entries.begin(), entries.end(), std::uint64_t{0}, std::plus<>(),
                            [](const CacheEntry& entry) { return entry.bytes; });
  const std::uint64_t over_limit = excess(cache_bytes(folder_) + bytes, max_bytes_);
  if (over_limit > removable) {
    throw InputError(folder_.string(), "the sequence needs " + size_text(bytes + used_bytes_) +
                                           ", more than the limit of the frame cache leaves (" +
                                           size_text(max_bytes_) + ", STILLPOINT_CACHE_SIZE)");
  }
  const std::uint64_t over_disk = excess(bytes + disk_reserve_bytes_, available_bytes(folder_));
  if (over_disk > removable) {
    throw InputError(folder_.string(), "the disk has no space for " + size_text(bytes) +
                                           " and a reserve of " + size_text(disk_reserve_bytes_) +
                                           "; free some space");
  }
  remove_files(entries, std::max(over_limit, over_disk));
}

void CacheSpace::expect(std::uint64_t bytes) {
  if (bytes <= granted_bytes_) return;
  make_room(bytes - used_bytes_);
  granted_bytes_ = bytes;
}

void CacheSpace::require(std::uint64_t bytes) {
  if (used_bytes_ + bytes > granted_bytes_) expect(used_bytes_ + bytes);
  // Other programs fill the disk, too.
  if (available_bytes(folder_) < bytes + disk_reserve_bytes_) make_room(bytes);
  used_bytes_ += bytes;
}

std::uint64_t size_from_text(const std::string& place, const std::string& text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  std::string unit(static_cast<const char*>(end), text.data() + text.size());
  std::erase(unit, ' ');
  if (!unit.empty() && (unit.back() == 'B' || unit.back() == 'b')) unit.pop_back();
  constexpr std::string_view kUnits = "KMGT";
  double factor = 1.0;
  bool known = unit.empty();
  for (std::size_t i = 0; i < kUnits.size() && !known; ++i) {
    factor *= kKilobyte;
    known = unit.size() == 1 && std::toupper(static_cast<unsigned char>(unit[0])) == kUnits[i];
  }
  const double bytes = number * factor;
  if (error != std::errc() || !known || !(bytes >= 0.0) || bytes > 1e18) {
    throw InputError(place, "\"" + text + "\" is not a size; write e.g. 20G, 500M or 0");
  }
  return static_cast<std::uint64_t>(bytes);
}

std::string size_text(std::uint64_t bytes) {
  double value = static_cast<double>(bytes);
  const char* unit = "B";
  for (const char* const larger : {"kB", "MB", "GB", "TB"}) {
    if (value < kKilobyte) break;
    value /= kKilobyte;
    unit = larger;
  }
  return bytes < kKilobyte ? fmt::format("{} B", bytes) : fmt::format("{:.3g} {}", value, unit);
}

}  // namespace stillpoint::datasets
