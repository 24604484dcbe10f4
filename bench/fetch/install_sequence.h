// SPDX-License-Identifier: BSD-3-Clause
/// Moves an extracted sequence to its final folder and registers it.
#pragma once

#include <filesystem>
#include <string>

#include "datasets/catalogue/catalogue.h"

namespace stillpoint::bench {

/// A sequence between extraction and registration.
struct InstalledSequence {
  const datasets::CatalogueDataset& dataset;
  const datasets::CatalogueSequence& sequence;
  std::filesystem::path staging;  ///< folder into which its archives were extracted
  std::filesystem::path folder;   ///< of the dataset
};

/// Where the archives contain the sequence, with rig.toml if the catalogue has one. Archives without a top
/// folder are moved into one.
/// @throws InputError if the archives do not contain it
[[nodiscard]] std::filesystem::path extracted_folder(const InstalledSequence& place);

/// Opens the extracted sequence, moves it to FOLDER/SEQUENCE.FOLDER and registers it. An equal folder that is
/// already there, left by an interrupted call, is used.
/// @return a line for the user
/// @throws InputError if the archives did not contain it, it is not a readable sequence, or another folder
/// has its place
[[nodiscard]] std::string install_sequence(const InstalledSequence& place);

}  // namespace stillpoint::bench
