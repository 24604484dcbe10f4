// SPDX-License-Identifier: BSD-3-Clause
/// One fingerprint of everything in a sequence's folder.
#pragma once

#include <filesystem>
#include <string>

namespace stillpoint {

/// Sixteen hexadecimal digits over the names and contents of all files below a folder, in order of their
/// names. Reads every byte.
/// @throws InputError if a file cannot be read
[[nodiscard]] std::string sequence_checksum(const std::filesystem::path& folder);

}  // namespace stillpoint
