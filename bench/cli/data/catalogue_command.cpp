// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/config/spelling.h"
#include "bench/fetch/fetch_sequences.h"
#include "bench/plan/dataset_catalogue.h"
#include "core/base/error.h"
#include "datasets/cache/cache_space.h"

namespace stillpoint::bench {
namespace {

using datasets::CatalogueArchive;
using datasets::CatalogueDataset;
using datasets::CatalogueSequence;

std::size_t available_sequences(const CatalogueDataset& dataset) {
  return static_cast<std::size_t>(std::ranges::count_if(
      dataset.sequences, [&](const CatalogueSequence& sequence) { return is_available(dataset, sequence); }));
}

/// Published size of all archives, "?" if none is published.
std::string total_size(const CatalogueDataset& dataset) {
  std::uint64_t bytes = 0;
  bool is_complete = !dataset.archives.empty();
  for (const CatalogueArchive& archive : dataset.archives) {
    bytes += archive.bytes;
    is_complete = is_complete && archive.bytes > 0;
  }
  if (bytes == 0) return "?";
  return (is_complete ? "" : "> ") + datasets::size_text(bytes);
}

int list_datasets(const std::vector<CatalogueDataset>& catalogues) {
  std::cout << fmt::format("{:<16} {:>9} {:>9} {:>10}  {:<28} {}\n", "dataset", "sequences", "available",
                           "size", "licence", "title");
  for (const CatalogueDataset& dataset : catalogues) {
    std::string licence = dataset.licence;
    if (licence.size() > 28) licence = licence.substr(0, 25) + "...";
    std::cout << fmt::format("{:<16} {:>9} {:>9} {:>10}  {:<28} {}\n", dataset.name, dataset.sequences.size(),
                             available_sequences(dataset), total_size(dataset), licence, dataset.title);
  }
  std::cout << fmt::format("\nOwn catalogue files: {}/*.toml\n", user_catalogue_folder().string());
  return kExitOk;
}

std::string digest_kind(const CatalogueDataset& dataset, const CatalogueArchive& archive) {
  if (!archive.sha256.empty()) return "SHA-256";
  if (!archive.md5.empty()) return "MD5";
  return dataset.md5_suffix.empty() ? "first use" : "MD5 of the host";
}

void print_sequences(const CatalogueDataset& dataset) {
  std::cout << fmt::format("\n{:<44} {:<14} {:>10} {:<16} {}\n", "sequence", "group", "archive", "digest",
                           "");
  std::set<std::string> printed;
  for (const CatalogueSequence& sequence : dataset.sequences) {
    std::string size;
    std::string digest;
    for (const std::string& file : sequence.archives) {
      const CatalogueArchive& archive = datasets::archive_of(dataset, file);
      const bool is_first = printed.insert(file).second;
      const std::string bytes = archive.bytes == 0 ? "?" : datasets::size_text(archive.bytes);
      size += (size.empty() ? "" : "+") + (is_first ? bytes : "same");
      digest = digest_kind(dataset, archive);
    }
    std::cout << fmt::format("{:<44} {:<14} {:>10} {:<16} {}\n", catalogue_name(dataset, sequence),
                             sequence.group, size, digest,
                             is_available(dataset, sequence) ? "available" : "");
  }
}

int show_dataset(const CatalogueDataset& dataset) {
  std::cout << fmt::format("{}\n  {}\n  homepage: {}\n  licence: {}\n  layout: {}\n", dataset.name,
                           dataset.title, dataset.homepage, dataset.licence, dataset.layout);
  if (!dataset.token_variable.empty())
    std::cout << "  token: environment variable " << dataset.token_variable << "\n";
  for (const std::string& note : dataset.notes) std::cout << "  - " << note << "\n";
  if (!dataset.manual.empty()) std::cout << "  by hand: " << dataset.manual << "\n";
  print_sequences(dataset);
  std::cout << "\n" << dataset.citation << "\n";
  return kExitOk;
}

int catalogue(const std::string& name) {
  const std::vector<CatalogueDataset> catalogues = load_catalogues();
  if (name.empty()) return list_datasets(catalogues);
  const auto found = std::ranges::find(catalogues, name, &CatalogueDataset::name);
  if (found != catalogues.end()) return show_dataset(*found);
  std::vector<std::string> names;
  for (const CatalogueDataset& dataset : catalogues) names.push_back(dataset.name);
  throw InputError("dataset \"" + name + "\"", "is not in the catalogue" + suggestion(name, names) +
                                                   "; `stillpoint data catalogue` lists the datasets");
}

}  // namespace

Command catalogue_command() {
  const auto name = std::make_shared<std::string>();
  return {
      .name = "catalogue",
      .summary = "List public datasets, or the sequences, licence and citation of one",
      .example = "data catalogue tum",
      .options = {{.name = "NAME", .help = "Dataset [all]", .target = name.get(), .may_be_omitted = true}},
      .action = [name] { return catalogue(*name); }};
}

}  // namespace stillpoint::bench
