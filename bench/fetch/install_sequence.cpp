// SPDX-License-Identifier: BSD-3-Clause
#include "bench/fetch/install_sequence.h"

#include <algorithm>

#include <fmt/format.h>

#include "bench/plan/sequence_registry.h"
#include "bench/record/output_folder.h"
#include "bench/record/sequence_checksum.h"
#include "core/base/error.h"
#include "datasets/open_sequence.h"
#include "datasets/sequence_validator.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using datasets::CatalogueDataset;
using datasets::CatalogueSequence;

/// Opens the sequence, and the index of a bag. @return its format
/// @throws InputError if it cannot be read, and for a bag that ends early
std::string validated(const InstalledSequence& place, const fs::path& path) {
  if (!datasets::ends_completely(path)) {
    throw InputError(
        datasets::catalogue_name(place.dataset, place.sequence),
        path.filename().string() +
            " is not complete: it ends early, so that it is not registered; the file of the host "
            "is damaged, use another one with --mirror");
  }
  // The calibration of a bag may be in a rig.toml that the user has yet to write.
  if (fs::is_regular_file(path)) return place.dataset.layout;
  return datasets::open_sequence(path)->info().format;
}

/// The calibration of the catalogue, for formats without one.
fs::path with_rig(const fs::path& folder, const std::string& rig) {
  if (!rig.empty() && fs::is_directory(folder) && !fs::exists(folder / "rig.toml"))
    write_files(folder, {{"rig.toml", rig}});
  return folder;
}

/// Moves `from` to `to`, unless an equal one is there.
void move_sequence(const fs::path& from, const fs::path& to, const std::string& checksum) {
  if (fs::exists(to)) {
    if (sequence_checksum(to) == checksum) return;
    throw InputError(to.string(),
                     "exists with other content than the downloaded sequence; move it away, or "
                     "choose another folder with --to");
  }
  fs::create_directories(to.parent_path());
  fs::rename(from, to);
}

}  // namespace

fs::path extracted_folder(const InstalledSequence& place) {
  const auto& [dataset, sequence, staging, dataset_folder] = place;
  if (fs::exists(staging / sequence.folder)) return with_rig(staging / sequence.folder, dataset.rig);
  const auto users = std::ranges::count_if(dataset.sequences, [&](const CatalogueSequence& other) {
    return other.archives == place.sequence.archives;
  });
  const fs::path folder = staging / ".content";
  if (users == 1 && !fs::is_empty(staging)) {
    fs::create_directory(folder);  // exists after the first call
    for (const fs::directory_entry& entry : fs::directory_iterator(staging)) {
      if (entry.path() != folder) fs::rename(entry.path(), folder / entry.path().filename());
    }
    return with_rig(folder, dataset.rig);
  }
  throw InputError(datasets::catalogue_name(dataset, sequence),
                   "its archives do not contain \"" + sequence.folder +
                       "\"; the host has changed them, or the catalogue is wrong: correct the folder there");
}

std::string install_sequence(const InstalledSequence& place) {
  const auto& [dataset, sequence, staging, folder] = place;
  const fs::path extracted = extracted_folder(place);
  const std::string format = validated(place, extracted);
  const std::string checksum = sequence_checksum(extracted);
  const fs::path target = folder / sequence.folder;
  move_sequence(extracted, target, checksum);
  const std::string name = datasets::registered_name(dataset, sequence);
  register_sequence(registry_file(),
                    {.name = name, .folder = fs::canonical(target), .checksum = checksum, .format = format},
                    Registration::kReplace);
  return fmt::format("registered {}: {} ({}, checksum {})", name, target.string(), format, checksum);
}

}  // namespace stillpoint::bench
