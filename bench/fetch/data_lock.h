// SPDX-License-Identifier: BSD-3-Clause
/// Downloads of the catalogue, verified: stillpoint.lock.json in the folder of downloads contains the digests
/// of the files that were downloaded first, and the licences that were accepted. Later downloads, registered
/// sequences and kept archives are compared with them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/plan/sequence_registry.h"
#include "datasets/catalogue/catalogue.h"
#include "datasets/download/archive_extraction.h"
#include "datasets/download/transfer_checks.h"

namespace stillpoint::bench {

/// A downloaded file at its first use.
struct LockedFile {
  std::uint64_t bytes = 0;
  std::string sha256;
  std::string url;
  std::string date;        ///< UTC
  bool published = false;  ///< verified by a published digest; false: trusted on first use
};

/// Content of the lock file.
struct DataLock {
  std::map<std::string, std::string> licences;  ///< date of acceptance by dataset
  std::map<std::string, LockedFile> files;      ///< by "dataset/file"
};

/// Empty if the folder has none.
/// @throws InputError if it is malformed
[[nodiscard]] DataLock read_data_lock(const std::filesystem::path& root);

/// Records an accepted licence; safe for several processes.
/// @throws InputError if it cannot be written
void lock_licence(const std::filesystem::path& root, const std::string& dataset);

/// How sequences of the catalogue are fetched.
struct FetchOptions {
  std::filesystem::path root;  ///< sequences are stored in ROOT/DATASET/FOLDER
  std::string mirror;          ///< address that serves MIRROR/DATASET/FILE, tried first; empty = none
  bool keep_archives = false;
  int attempts = 5;  ///< per address
  double first_backoff_s = 1.0;
  int stall_timeout_s = 30;
  datasets::ExtractionLimits limits;
  bool record_boxes = false;  ///< fetch a detection network, and record the boxes of sequences without any
};

/// How the progress of a step is displayed and the whole operation is stopped.
struct FetchControl {
  /// @param label what is done with which file, e.g. "downloading a.tgz"
  std::function<datasets::TransferControl(const std::string& label)> step;
  std::function<void(const std::string&)> report;  ///< one line about something that is complete
};

/// Where a file of the catalogue is stored: ROOT/DATASET/downloads/NAME.
[[nodiscard]] std::filesystem::path download_path(const std::filesystem::path& root,
                                                  const datasets::CatalogueDataset& dataset,
                                                  const std::string& file);

/// A file of the catalogue that has been downloaded.
struct LockedDownload {
  std::string key;                      ///< "dataset/file"
  std::optional<LockedFile> first_use;  ///< to be recorded; nullopt if it is
};

/// Downloads to `download_path`, whose folder is created. Without a published SHA-256, that of the first use
/// is required.
/// @return nullopt if stopped
/// @throws InputError as `datasets::download`
[[nodiscard]] std::optional<LockedDownload> download_locked(const datasets::CatalogueDataset& dataset,
                                                            const datasets::CatalogueArchive& archive,
                                                            const FetchOptions& options,
                                                            const FetchControl& control);

/// Records the digest of a file at its first use, after its content was found to be intact: that of a damaged
/// one would refuse the right file for ever. Safe for several processes.
/// @throws InputError if it cannot be written
void record_first_use(const LockedDownload& download, const FetchOptions& options,
                      const FetchControl& control);

enum class VerifiedState { kEqual, kChanged, kMissing };

/// Reads every byte of a registered sequence.
/// @throws InputError if a file cannot be read
[[nodiscard]] VerifiedState verify_sequence(const RegisteredSequence& sequence);

struct VerifiedFile {
  std::string file;
  VerifiedState state = VerifiedState::kEqual;
};

/// Archives that were kept in the folder of downloads.
/// @return those that were read before `control` stopped it
/// @throws InputError if a file cannot be read
[[nodiscard]] std::vector<VerifiedFile> verify_archives(const std::filesystem::path& root,
                                                        const datasets::TransferControl& control);

}  // namespace stillpoint::bench
