// SPDX-License-Identifier: BSD-3-Clause
/// Downloads, extracts, validates and registers sequences of the catalogue.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/fetch/data_lock.h"
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

/// The folder of downloads: $STILLPOINT_DATA, else stillpoint in $XDG_DATA_HOME or ~/.local/share.
/// @throws InputError if none of the three variables (the last: HOME) is set
[[nodiscard]] std::filesystem::path download_root();

/// Whether the sequence is registered and its files exist.
[[nodiscard]] bool is_available(const datasets::CatalogueDataset& dataset,
                                const datasets::CatalogueSequence& sequence);

struct FetchResult {
  bool stopped = false;
  std::vector<std::string> problems;  ///< why archives could not be fetched; one message each
};

/// Fetches the entries that are not available, and the other sequences of their archives. A sequence is
/// registered after all of it was extracted and opened as a sequence, and boxes were recorded if requested,
/// so an interruption or a failure registers nothing of it. Several processes may fetch at once; one of them
/// downloads a file.
/// An archive that cannot be downloaded, or is not what was expected, is a problem of the result; the others
/// are fetched nevertheless.
/// @throws InputError if the licence has not been accepted, or the dataset can only be fetched by hand
[[nodiscard]] FetchResult fetch_sequences(const std::vector<datasets::CatalogueEntry>& entries,
                                          const FetchOptions& options, const FetchControl& control);

/// Datasets of the entries whose licence has not been accepted in this folder of downloads.
[[nodiscard]] std::vector<const datasets::CatalogueDataset*> unaccepted_licences(
    const std::vector<datasets::CatalogueEntry>& entries, const std::filesystem::path& root);

}  // namespace stillpoint::bench
