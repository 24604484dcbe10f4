// SPDX-License-Identifier: BSD-3-Clause
/// stillpoint.lock.json in the folder of downloads: digests of the files that were downloaded first, and the
/// licences that were accepted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace stillpoint::bench {

/// A downloaded file at its first use.
struct LockedFile {
  std::uint64_t bytes = 0;
  std::string sha256;
  std::string url;
  std::string date;        ///< UTC
  bool published = false;  ///< verified by a published digest; false: trusted on first use
};

struct DataLock {
  std::map<std::string, std::string> licences;  ///< date of acceptance by dataset
  std::map<std::string, LockedFile> files;      ///< by "dataset/file"
};

/// Empty if the folder has none.
/// @throws InputError if it is malformed
[[nodiscard]] DataLock read_data_lock(const std::filesystem::path& root);

/// Records an accepted licence; safe for several processes.
/// @throws InputError if it cannot be written
void lock_licence(const std::filesystem::path& root, const std::string& dataset);

/// Records a downloaded file unless it is recorded; safe for several processes.
/// @throws InputError if it cannot be written
void lock_file(const std::filesystem::path& root, const std::string& key, const LockedFile& file);

}  // namespace stillpoint::bench
