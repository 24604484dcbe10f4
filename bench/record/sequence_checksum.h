// SPDX-License-Identifier: BSD-3-Clause
/// Checksum of a sequence folder.
#pragma once

#include <filesystem>
#include <string>

namespace stillpoint::bench {

/// Hash of the names and contents of all files below a folder, sorted by name, as sixteen hexadecimal digits;
/// of the content of a file. Reads every byte.
/// @throws InputError if a file cannot be read
[[nodiscard]] std::string sequence_checksum(const std::filesystem::path& folder);

}  // namespace stillpoint::bench
