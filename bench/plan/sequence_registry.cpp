// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/sequence_registry.h"

#include <algorithm>
#include <map>

#include <nlohmann/json.hpp>

#include "bench/config/toml_source.h"
#include "bench/model/json_problem.h"
#include "bench/process/file_lock.h"
#include "bench/record/output_folder.h"
#include "core/base/error.h"
#include "datasets/cache/user_folder.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void require_valid_name(const std::string& name) {
  constexpr std::string_view kAllowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  if (!name.empty() && name.find_first_not_of(kAllowed) == std::string::npos) return;
  throw InputError("sequence name \"" + name + "\"",
                   "is invalid; use letters, digits, '_', '-' and '.' only");
}

std::string registry_text(const std::vector<RegisteredSequence>& sequences) {
  Json json;
  json["schema"] = 1;
  json["sequences"] = Json::array();
  for (const RegisteredSequence& sequence : sequences) {
    json["sequences"].push_back({{"name", sequence.name},
                                 {"folder", sequence.folder.string()},
                                 {"checksum", sequence.checksum},
                                 {"format", sequence.format}});
  }
  return json.dump(2) + "\n";
}

/// @throws InputError if the name is that of another folder
void require_unused(const std::vector<RegisteredSequence>& sequences, const RegisteredSequence& added) {
  const auto known = std::ranges::find(sequences, added.name, &RegisteredSequence::name);
  if (known == sequences.end() || known->folder == added.folder) return;
  throw InputError("sequence name \"" + added.name + "\"",
                   "is registered for " + known->folder.string() +
                       "; choose another name, or replace the registration with --force");
}

}  // namespace

fs::path registry_file() {
  if (const fs::path file = datasets::variable_or_empty("STILLPOINT_REGISTRY"); !file.empty())
    return fs::absolute(file);
  const fs::path folder = datasets::user_folder("XDG_CONFIG_HOME", ".config");
  return folder.empty() ? folder : folder / "sequences.json";
}

std::vector<RegisteredSequence> read_registry(const fs::path& file) {
  std::vector<RegisteredSequence> sequences;
  if (!fs::exists(file)) return sequences;
  try {
    const Json json = Json::parse(eval::read_text_file(file));
    for (const Json& entry : json.at("sequences")) {
      sequences.push_back({.name = entry.at("name").get<std::string>(),
                           .folder = entry.at("folder").get<std::string>(),
                           .checksum = entry.at("checksum").get<std::string>(),
                           .format = entry.at("format").get<std::string>()});
    }
  } catch (const Json::exception& error) {
    throw InputError(file.string(), "is not a valid sequence registry: " + json_problem(error) +
                                        "; remove it and register the sequences again with "
                                        "`stillpoint data add`");
  }
  return sequences;
}

void register_sequence(const fs::path& file, const RegisteredSequence& sequence, Registration registration) {
  require_valid_name(sequence.name);
  if (file.empty())
    throw InputError("STILLPOINT_REGISTRY",
                     "is not set, and neither is HOME; set it to the file for registered sequences");
  require_utf8("folder", sequence.folder.string());
  std::error_code ignored;  // the lock reports a folder that cannot be written
  fs::create_directories(file.parent_path(), ignored);
  const FileLock exclusive(file.string() + ".lock", LockKind::kExclusive);
  std::vector<RegisteredSequence> sequences = read_registry(file);
  if (registration == Registration::kNew) require_unused(sequences, sequence);
  std::erase_if(sequences, [&](const RegisteredSequence& known) { return known.name == sequence.name; });
  sequences.push_back(sequence);
  std::sort(sequences.begin(), sequences.end(),
            [](const RegisteredSequence& a, const RegisteredSequence& b) { return a.name < b.name; });
  write_files(file.parent_path(), {{file.filename().string(), registry_text(sequences)}});
}

fs::path user_catalogue_folder() {
  if (fs::path folder = datasets::variable_or_empty("STILLPOINT_CATALOGUE"); !folder.empty()) return folder;
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
  datasets.reserve(by_name.size());
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
