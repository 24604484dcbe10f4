// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/catalogue/catalogue.h"

#include <algorithm>

#include <fnmatch.h>

#include "core/base/error.h"

namespace stillpoint::datasets {

const CatalogueArchive& archive_of(const CatalogueDataset& dataset, const std::string& file) {
  const auto found = std::ranges::find(dataset.archives, file, &CatalogueArchive::file);
  STILLPOINT_CHECK(found != dataset.archives.end());
  return *found;
}

std::string catalogue_name(const CatalogueDataset& dataset, const CatalogueSequence& sequence) {
  return dataset.name + "/" + sequence.name;
}

std::string registered_name(const CatalogueDataset& dataset, const CatalogueSequence& sequence) {
  return dataset.name + "_" + sequence.name;
}

std::uint64_t published_bytes(const CatalogueDataset& dataset, const std::vector<std::string>& files) {
  std::uint64_t sum = 0;
  for (const std::string& file : files) {
    const std::uint64_t bytes = archive_of(dataset, file).bytes;
    if (bytes == 0) return 0;
    sum += bytes;
  }
  return sum;
}

std::vector<CatalogueEntry> matching_entries(const std::vector<CatalogueDataset>& datasets,
                                             const std::string& pattern) {
  std::vector<CatalogueEntry> found;
  for (const CatalogueDataset& dataset : datasets) {
    for (const CatalogueSequence& sequence : dataset.sequences) {
      const auto matches = [&](const std::string& name) {
        return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
      };
      const bool in_group = !sequence.group.empty() && matches(dataset.name + "/" + sequence.group);
      if (matches(catalogue_name(dataset, sequence)) || matches(registered_name(dataset, sequence)) ||
          in_group || pattern == dataset.name) {
        found.push_back({&dataset, &sequence});
      }
    }
  }
  return found;
}

}  // namespace stillpoint::datasets
