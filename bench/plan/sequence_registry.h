// SPDX-License-Identifier: BSD-3-Clause
/// Names for recorded sequences, with the checksum that they had when they were named.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillpoint {

struct RegisteredSequence {
  std::string name;
  std::filesystem::path folder;
  std::string checksum;  ///< of its files, see bench/record/sequence_checksum.h
  std::string format;
};

/// $STILLPOINT_REGISTRY, else sequences.json in $XDG_CONFIG_HOME/stillpoint or ~/.config/stillpoint.
[[nodiscard]] std::filesystem::path registry_file();

/// Empty if there is no such file.
/// @throws InputError if it is malformed
[[nodiscard]] std::vector<RegisteredSequence> read_registry(const std::filesystem::path& file);

/// Adds a sequence, or replaces the one of that name.
/// @throws InputError if the name is not made of letters, digits, '_', '-' and '.', or the file cannot be
/// written
void register_sequence(const std::filesystem::path& file, const RegisteredSequence& sequence);

}  // namespace stillpoint
