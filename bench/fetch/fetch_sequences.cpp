// SPDX-License-Identifier: BSD-3-Clause
#include "bench/fetch/fetch_sequences.h"

#include <algorithm>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "bench/fetch/box_recording.h"
#include "bench/plan/sequence_registry.h"
#include "bench/process/file_lock.h"
#include "bench/record/output_folder.h"
#include "bench/record/sequence_checksum.h"
#include "core/base/error.h"
#include "datasets/bags/bag_file.h"
#include "datasets/cache/user_folder.h"
#include "datasets/download/transfer_checks.h"
#include "datasets/open_sequence.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using datasets::CatalogueDataset;
using datasets::CatalogueSequence;

/// Whether a path is no bag, or a bag of which no file ends early.
/// @throws InputError if a bag cannot be read at all
bool ends_completely(const fs::path& path) {
  return !eval::is_bag(path) || datasets::BagFile(path).is_complete();
}

/// Opens the sequence, and the index of a bag. @return its format
/// @throws InputError if it cannot be read, and for a bag that ends early
std::string validated(const InstalledSequence& place, const fs::path& path) {
  if (!ends_completely(path)) {
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

namespace {

using datasets::CatalogueArchive;
using datasets::CatalogueEntry;

/// Opens the extracted sequence, moves it to FOLDER/SEQUENCE.FOLDER and registers it. An equal folder that is
/// already there, left by an interrupted call, is used.
/// @return a line for the user
/// @throws InputError if the archives did not contain it, it is not a readable sequence, or another folder
/// has its place
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

/// Extracted files per byte of an archive: images hardly compress, and a nested archive exists with its
/// content for a moment.
constexpr double kExtractedRatio = 1.5;

/// Fetches the archives of one sequence, and all sequences in them.
class ArchiveFetch {
 public:
  ArchiveFetch(const CatalogueEntry& entry, const FetchOptions& options, const FetchControl& control)
      : dataset_(*entry.dataset),
        files_(entry.sequence->archives),
        options_(options),
        control_(control),
        folder_(options.root / dataset_.name),
        staging_(folder_ / (".extracting-" + fs::path(files_.front()).filename().string())) {}

  /// @return false if stopped
  bool run() {
    fs::create_directories(folder_ / "downloads");
    const fs::path name = fs::path(files_.front()).filename();
    const FileLock exclusive(folder_ / "downloads" / ("." + name.string() + ".lock"), LockKind::kExclusive);
    if (missing().empty()) return true;  // another process fetched them
    require_space();
    fs::remove_all(staging_);
    fs::create_directories(staging_);
    const StagingRemoval removal{staging_};
    for (const std::string& file : files_) {
      if (!fetch_archive(datasets::archive_of(dataset_, file))) return false;
    }
    for (const CatalogueSequence* sequence : missing()) {
      const InstalledSequence place{dataset_, *sequence, staging_, folder_};
      if (options_.record_boxes && !record_missing_boxes(place, options_, control_)) return false;
      control_.report(install_sequence(place));
    }
    if (options_.keep_archives) return true;
    for (const std::string& file : files_) fs::remove(download_path(options_.root, dataset_, file));
    return true;
  }

 private:
  struct StagingRemoval {
    fs::path folder;
    ~StagingRemoval() {
      std::error_code ignored;
      fs::remove_all(folder, ignored);
    }
  };

  /// The sequences in these archives that are not available.
  [[nodiscard]] std::vector<const CatalogueSequence*> missing() const {
    std::vector<const CatalogueSequence*> found;
    for (const CatalogueSequence& sequence : dataset_.sequences) {
      if (sequence.archives == files_ && !is_available(dataset_, sequence)) found.push_back(&sequence);
    }
    return found;
  }

  void require_space() const {
    const auto bytes = static_cast<double>(datasets::published_bytes(dataset_, files_));
    datasets::require_disk_space(folder_, static_cast<std::uint64_t>(bytes * (1.0 + kExtractedRatio)));
  }

  /// Downloads to the folder of downloads, and extracts to the staging folder. @return false if stopped
  bool fetch_archive(const CatalogueArchive& archive) {
    const std::optional<LockedDownload> download = download_locked(dataset_, archive, options_, control_);
    if (!download || !extract(download_path(options_.root, dataset_, archive.file))) return false;
    record_first_use(*download, options_, control_);
    return true;
  }

  bool extract(const fs::path& file) {
    if (!datasets::has_archive_name(file)) {
      std::error_code error;
      fs::create_hard_link(file, staging_ / file.filename(), error);
      if (error) fs::copy_file(file, staging_ / file.filename());
      return true;
    }
    const datasets::TransferControl step = control_.step("extracting " + file.filename().string());
    datasets::ExtractionLimits limits = options_.limits;
    limits.before = totals_;
    totals_ = datasets::extract_archive(file, staging_, limits, step);
    return !totals_.stopped;
  }

  const CatalogueDataset& dataset_;
  const std::vector<std::string>& files_;
  const FetchOptions& options_;
  const FetchControl& control_;
  fs::path folder_;
  fs::path staging_;
  datasets::ExtractionTotals totals_;
};

/// @throws InputError if a program cannot fetch the dataset
void require_addresses(const CatalogueEntry& entry, const std::string& mirror) {
  const CatalogueDataset& dataset = *entry.dataset;
  const std::string name = datasets::catalogue_name(dataset, *entry.sequence);
  const bool has_address =
      !entry.sequence->archives.empty() &&
      (!mirror.empty() || std::ranges::none_of(entry.sequence->archives, [&](const std::string& file) {
        return datasets::archive_of(dataset, file).urls.empty();
      }));
  if (has_address) return;
  throw InputError(name, dataset.manual.empty()
                             ? "the catalogue has no address of its files; set one with --mirror"
                             : "cannot be fetched by a program: " + dataset.manual);
}

/// @return false if stopped
bool fetch_entry(const CatalogueEntry& entry, const FetchOptions& options, const FetchControl& control) {
  if (entry.dataset->layout == kDetectorLayout) return fetch_detector(*entry.dataset, options, control);
  if (is_available(*entry.dataset, *entry.sequence)) return true;
  return ArchiveFetch(entry, options, control).run();
}

}  // namespace

fs::path download_root() {
  if (fs::path folder = datasets::variable_or_empty("STILLPOINT_DATA"); !folder.empty()) return folder;
  if (fs::path folder = datasets::user_folder("XDG_DATA_HOME", ".local/share"); !folder.empty())
    return folder;
  throw InputError("STILLPOINT_DATA", "is not set, and neither is HOME; set it to the folder for downloads");
}

bool is_available(const CatalogueDataset& dataset, const CatalogueSequence& sequence) {
  const std::vector<RegisteredSequence> registry = read_registry(registry_file());
  const auto found =
      std::ranges::find(registry, registered_name(dataset, sequence), &RegisteredSequence::name);
  std::error_code ignored;
  return found != registry.end() && fs::exists(found->folder, ignored);
}

FetchResult fetch_sequences(const std::vector<CatalogueEntry>& entries, const FetchOptions& options,
                            const FetchControl& control) {
  if (!unaccepted_licences(entries, options.root).empty())
    throw InputError("licence", "has not been accepted; specify --accept-licence");
  for (const CatalogueEntry& entry : entries) {
    if (!is_available(*entry.dataset, *entry.sequence)) require_addresses(entry, options.mirror);
  }
  FetchResult result;
  std::set<std::vector<std::string>> failed;  // archives; several sequences may need the same ones
  for (const CatalogueEntry& entry : entries) {
    if (failed.contains(entry.sequence->archives)) continue;
    try {
      result.stopped = !fetch_entry(entry, options, control);
    } catch (const InputError& error) {
      result.problems.emplace_back(error.what());
      failed.insert(entry.sequence->archives);
    }
    if (result.stopped) break;
  }
  return result;
}

std::vector<const CatalogueDataset*> unaccepted_licences(const std::vector<CatalogueEntry>& entries,
                                                         const fs::path& root) {
  const DataLock lock = read_data_lock(root);
  std::vector<const CatalogueDataset*> found;
  for (const CatalogueEntry& entry : entries) {
    const bool is_known = std::ranges::find(found, entry.dataset) != found.end();
    if (!is_known && !lock.licences.contains(entry.dataset->name)) found.push_back(entry.dataset);
  }
  return found;
}

}  // namespace stillpoint::bench
