// SPDX-License-Identifier: BSD-3-Clause
/// Download of one file of the catalogue, verified by published digests and the lock file.
#pragma once

#include <filesystem>
#include <string>

#include "bench/fetch/fetch_options.h"
#include "datasets/catalogue/catalogue.h"

namespace stillpoint::bench {

/// Where a file of the catalogue is stored: ROOT/DATASET/downloads/NAME.
[[nodiscard]] std::filesystem::path download_path(const std::filesystem::path& root,
                                                  const datasets::CatalogueDataset& dataset,
                                                  const std::string& file);

/// Downloads to `download_path`, whose folder is created. Without a published SHA-256, that of the first
/// download is required.
/// @return false if stopped
/// @throws InputError as `datasets::download`
[[nodiscard]] bool download_locked(const datasets::CatalogueDataset& dataset,
                                   const datasets::CatalogueArchive& archive, const FetchOptions& options,
                                   const FetchControl& control);

}  // namespace stillpoint::bench
