// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/dataset_catalogue.h"

#include <algorithm>
#include <cstdlib>
#include <map>

#include "bench/config/toml_source.h"
#include "bench/plan/sequence_registry.h"

namespace stillpoint::bench {

namespace fs = std::filesystem;

fs::path user_catalogue_folder() {
  if (const char* folder = std::getenv("STILLPOINT_CATALOGUE")) return folder;
  return registry_file().parent_path() / "catalogue";
}

std::vector<datasets::CatalogueDataset> load_catalogues() {
  std::map<std::string, datasets::CatalogueDataset> by_name;
  const auto add = [&by_name](const TomlSource& source) {
    datasets::CatalogueDataset dataset = datasets::parse_catalogue(source.text, source.path);
    const std::string name = dataset.name;
    by_name.insert_or_assign(name, std::move(dataset));
  };
  for (const std::string& name : embedded_names(TomlKind::kCatalogue))
    add(find_toml(name, TomlKind::kCatalogue));
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(user_catalogue_folder(), ignored)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) add(find_toml(file.string(), TomlKind::kCatalogue));
  std::vector<datasets::CatalogueDataset> datasets;
  for (auto& [name, dataset] : by_name) datasets.push_back(std::move(dataset));
  return datasets;
}

std::string fetch_advice(const std::vector<datasets::CatalogueDataset>& datasets,
                         const std::string& pattern) {
  const std::vector<datasets::CatalogueEntry> entries = datasets::matching_entries(datasets, pattern);
  if (entries.empty()) return "";
  const datasets::CatalogueDataset& dataset = *entries.front().dataset;
  if (!dataset.manual.empty()) return "see `stillpoint data catalogue " + dataset.name + "`";
  const std::string name =
      entries.size() == 1 ? datasets::catalogue_name(dataset, *entries.front().sequence) : pattern;
  return "run `stillpoint data get " + name + "`";
}

}  // namespace stillpoint::bench
