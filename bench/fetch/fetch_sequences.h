// SPDX-License-Identifier: BSD-3-Clause
/// Downloads, extracts, validates and registers sequences of the catalogue.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "datasets/catalogue/catalogue.h"
#include "datasets/download/archive_extraction.h"
#include "datasets/download/download.h"

namespace stillpoint::bench {

struct FetchOptions {
  std::filesystem::path root;  ///< sequences are stored in ROOT/DATASET/FOLDER
  std::string mirror;          ///< address that serves MIRROR/DATASET/FILE, tried first; empty = none
  bool keep_archives = false;
  int attempts = 5;  ///< per address
  double first_backoff_s = 1.0;
  int stall_timeout_s = 30;
  datasets::ExtractionLimits limits;
};

/// How the progress of a step is displayed and the whole operation is stopped.
struct FetchControl {
  /// @param label what is done with which file, e.g. "downloading a.tgz"
  std::function<datasets::TransferControl(const std::string& label)> step;
  std::function<void(const std::string&)> report;  ///< one line about something that is complete
};

/// The folder of downloads: $STILLPOINT_DATA, else stillpoint in $XDG_DATA_HOME or ~/.local/share.
[[nodiscard]] std::filesystem::path download_root();

/// Whether the sequence is registered and its files exist.
[[nodiscard]] bool is_available(const datasets::CatalogueDataset& dataset,
                                const datasets::CatalogueSequence& sequence);

/// Fetches the entries that are not available, and the other sequences of their archives. A sequence is
/// registered after all of it was extracted and opened as a sequence, so an interruption or a failure
/// registers nothing of it. Several processes may fetch at once; one of them downloads a file.
/// @return false if stopped
/// @throws InputError if the licence has not been accepted (`accept_licence`), the disk is full, a file
/// cannot be downloaded or is not what was expected, or the dataset can only be fetched by hand
[[nodiscard]] bool fetch_sequences(const std::vector<datasets::CatalogueEntry>& entries,
                                   const FetchOptions& options, const FetchControl& control);

/// Datasets of the entries whose licence has not been accepted in this folder of downloads.
[[nodiscard]] std::vector<const datasets::CatalogueDataset*> unaccepted_licences(
    const std::vector<datasets::CatalogueEntry>& entries, const std::filesystem::path& root);

}  // namespace stillpoint::bench
