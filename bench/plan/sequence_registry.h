// SPDX-License-Identifier: BSD-3-Clause
/// The recorded sequences that are known: the registry of names with checksums at registration, and the
/// catalogue of public datasets, of embedded files and those of the user.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/catalogue/catalogue.h"

namespace stillpoint::bench {

struct RegisteredSequence {
  std::string name;
  std::filesystem::path folder;
  std::string checksum;  ///< of the files, see bench/record/sequence_checksum.h
  std::string format;
};

/// $STILLPOINT_REGISTRY, else sequences.json in $XDG_CONFIG_HOME/stillpoint or ~/.config/stillpoint; empty if
/// none of the three variables (the last: HOME) is set.
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

/// Folder of the user's catalogue files: $STILLPOINT_CATALOGUE, else `catalogue` beside the registry file.
[[nodiscard]] std::filesystem::path user_catalogue_folder();

/// All datasets, sorted by name. A file of the user replaces the embedded dataset with the same name.
/// @throws InputError if a file of the user is malformed
[[nodiscard]] std::vector<datasets::CatalogueDataset> load_catalogues();

/// The command that fetches the sequences which a pattern selects, e.g. "run `stillpoint data get
/// tum/fr3_walking_xyz`"; empty if the catalogue has none.
[[nodiscard]] std::string fetch_advice(const std::vector<datasets::CatalogueDataset>& datasets,
                                       const std::string& pattern);

}  // namespace stillpoint::bench
