// SPDX-License-Identifier: BSD-3-Clause
/// Registry of named recorded sequences with their checksums at registration.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillpoint::bench {

struct RegisteredSequence {
  std::string name;
  std::filesystem::path folder;
  std::string checksum;  ///< of the files, see bench/record/sequence_checksum.h
  std::string format;
};

/// $STILLPOINT_REGISTRY, else sequences.json in $XDG_CONFIG_HOME/stillpoint or ~/.config/stillpoint.
[[nodiscard]] std::filesystem::path registry_file();

/// Returns an empty list if the file does not exist.
/// @throws InputError if the file is malformed
[[nodiscard]] std::vector<RegisteredSequence> read_registry(const std::filesystem::path& file);

/// Whether a name that is registered for another folder may be registered again.
enum class Registration { kNew, kReplace };

/// Adds a sequence, or updates the one with the same name and folder.
/// @throws InputError if the name has other characters than letters, digits, '_', '-' and '.', if it is
/// registered for another folder and `registration` is `kNew`, or if the file cannot be written
void register_sequence(const std::filesystem::path& file, const RegisteredSequence& sequence,
                       Registration registration = Registration::kNew);

}  // namespace stillpoint::bench
