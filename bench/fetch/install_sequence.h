// SPDX-License-Identifier: BSD-3-Clause
/// Moves an extracted sequence to its final folder and registers it.
#pragma once

#include <filesystem>
#include <string>

#include "datasets/catalogue/catalogue.h"

namespace stillpoint::bench {

/// Opens the extracted sequence, moves it to FOLDER/SEQUENCE.FOLDER and registers it. An equal folder that is
/// already there, left by an interrupted call, is used.
/// @param staging folder into which its archives were extracted
/// @param folder of the dataset
/// @return a line for the user
/// @throws InputError if the archives did not contain it, it is not a readable sequence, or another folder
/// has its place
[[nodiscard]] std::string install_sequence(const datasets::CatalogueDataset& dataset,
                                           const datasets::CatalogueSequence& sequence,
                                           const std::filesystem::path& staging,
                                           const std::filesystem::path& folder);

}  // namespace stillpoint::bench
