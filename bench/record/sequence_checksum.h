// SPDX-License-Identifier: BSD-3-Clause
/// Checksum of a sequence folder, remembered so that not all of its files are read in every run.
#pragma once

#include <filesystem>
#include <string>

namespace stillpoint::bench {

/// Hash of the names and contents of all files below a folder, sorted by name, as sixteen hexadecimal digits;
/// of the content of a file. Reads every byte.
/// @throws InputError if a file cannot be read
[[nodiscard]] std::string sequence_checksum(const std::filesystem::path& folder);

/// `sequence_checksum(folder)`. It is remembered in `cache`, with the names, sizes, modification times and
/// inodes of all files, and computed again if any of these differs. A cache that cannot be read or written
/// has no effect.
/// @param cache folder, created if necessary; empty: nothing is remembered
/// @throws InputError as `sequence_checksum`
[[nodiscard]] std::string remembered_checksum(const std::filesystem::path& folder,
                                              const std::filesystem::path& cache);

}  // namespace stillpoint::bench
