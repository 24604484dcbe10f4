// SPDX-License-Identifier: BSD-3-Clause
/// The catalogue of public datasets: embedded files, and those of the user.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/catalogue/catalogue.h"

namespace stillpoint::bench {

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
