// SPDX-License-Identifier: BSD-3-Clause
#include "bench/fetch/data_lock.h"

#include <cstdlib>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/json_problem.h"
#include "bench/model/stored_run.h"
#include "bench/process/file_lock.h"
#include "bench/record/output_folder.h"
#include "bench/record/sequence_checksum.h"
#include "core/base/error.h"
#include "datasets/download/download.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using datasets::CatalogueArchive;
using datasets::CatalogueDataset;

constexpr const char* kLockName = "stillpoint.lock.json";

std::string lock_text(const DataLock& lock) {
  Json json;
  json["schema"] = 1;
  json["licences"] = lock.licences;
  json["files"] = Json::object();
  for (const auto& [key, file] : lock.files) {
    json["files"][key] = {{"bytes", file.bytes},
                          {"sha256", file.sha256},
                          {"url", file.url},
                          {"date", file.date},
                          {"published", file.published}};
  }
  return json.dump(2) + "\n";
}

/// Reads, changes and writes the file while no other process does.
template <class Change>
void change_lock(const fs::path& root, const Change& change) {
  const FileLock exclusive(root / ".stillpoint.lock", LockKind::kExclusive);
  DataLock lock = read_data_lock(root);
  change(lock);
  write_files(root, {{kLockName, lock_text(lock)}});
}

/// Records a downloaded file unless it is recorded; safe for several processes.
/// @throws InputError if it cannot be written
void lock_file(const fs::path& root, const std::string& key, const LockedFile& file) {
  change_lock(root, [&](DataLock& lock) { lock.files.insert({key, file}); });
}

datasets::DownloadRequest request_of(const CatalogueDataset& dataset, const CatalogueArchive& archive,
                                     const FetchOptions& options) {
  datasets::DownloadRequest request{.file = download_path(options.root, dataset, archive.file),
                                    .urls = archive.urls,
                                    .bytes = archive.bytes,
                                    .sha256 = archive.sha256,
                                    .md5 = archive.md5,
                                    .md5_suffix = dataset.md5_suffix,
                                    .settings = {},
                                    .attempts = options.attempts,
                                    .first_backoff_s = options.first_backoff_s};
  if (!options.mirror.empty())
    request.urls.insert(request.urls.begin(), options.mirror + "/" + dataset.name + "/" + archive.file);
  request.settings.user_agent = dataset.user_agent;
  request.settings.stall_timeout_s = options.stall_timeout_s;
  const char* token = dataset.token_variable.empty() ? nullptr : std::getenv(dataset.token_variable.c_str());
  if (token != nullptr) request.settings.token = token;
  return request;
}

}  // namespace

DataLock read_data_lock(const fs::path& root) {
  const fs::path file = root / kLockName;
  DataLock lock;
  if (!fs::exists(file)) return lock;
  try {
    const Json json = Json::parse(eval::read_text_file(file));
    lock.licences = json.at("licences").get<std::map<std::string, std::string>>();
    for (const auto& [key, entry] : json.at("files").items()) {
      lock.files[key] = {.bytes = entry.at("bytes").get<std::uint64_t>(),
                         .sha256 = entry.at("sha256").get<std::string>(),
                         .url = entry.at("url").get<std::string>(),
                         .date = entry.at("date").get<std::string>(),
                         .published = entry.at("published").get<bool>()};
    }
  } catch (const Json::exception& error) {
    throw InputError(file.string(), "is not a valid lock file: " + json_problem(error) +
                                        "; restore it, or remove it to trust the next downloads");
  }
  return lock;
}

void lock_licence(const fs::path& root, const std::string& dataset) {
  change_lock(root, [&](DataLock& lock) { lock.licences.insert({dataset, utc_now()}); });
}

fs::path download_path(const fs::path& root, const CatalogueDataset& dataset, const std::string& file) {
  return root / dataset.name / "downloads" / fs::path(file).filename();
}

std::optional<LockedDownload> download_locked(const CatalogueDataset& dataset,
                                              const CatalogueArchive& archive, const FetchOptions& options,
                                              const FetchControl& control) {
  LockedDownload result{.key = dataset.name + "/" + archive.file, .first_use = {}};
  datasets::DownloadRequest request = request_of(dataset, archive, options);
  fs::create_directories(request.file.parent_path());
  const DataLock lock = read_data_lock(options.root);
  const auto locked = lock.files.find(result.key);
  if (request.sha256.empty() && locked != lock.files.end()) request.sha256 = locked->second.sha256;
  const std::string name = request.file.filename().string();
  const auto downloaded = datasets::download(request, control.step("downloading " + name));
  if (!downloaded) return std::nullopt;
  if (locked != lock.files.end()) return result;
  result.first_use = LockedFile{.bytes = downloaded->digests.bytes,
                                .sha256 = downloaded->digests.sha256,
                                .url = downloaded->url,
                                .date = utc_now(),
                                .published = !archive.sha256.empty() || !archive.md5.empty()};
  return result;
}

void record_first_use(const LockedDownload& download, const FetchOptions& options,
                      const FetchControl& control) {
  if (!download.first_use) return;
  lock_file(options.root, download.key, *download.first_use);
  if (download.first_use->published) return;
  control.report(fmt::format("{}: no digest is published; SHA-256 {} is recorded and required from now on",
                             fs::path(download.key).filename().string(), download.first_use->sha256));
}

VerifiedState verify_sequence(const RegisteredSequence& sequence) {
  std::error_code ignored;
  if (!fs::exists(sequence.folder, ignored)) return VerifiedState::kMissing;
  return sequence_checksum(sequence.folder) == sequence.checksum ? VerifiedState::kEqual
                                                                 : VerifiedState::kChanged;
}

std::vector<VerifiedFile> verify_archives(const fs::path& root, const datasets::TransferControl& control) {
  std::vector<VerifiedFile> verified;
  for (const auto& [key, locked] : read_data_lock(root).files) {
    const fs::path dataset = *fs::path(key).begin();
    const fs::path file = root / dataset / "downloads" / fs::path(key).filename();
    if (!fs::exists(file)) continue;
    const auto digests = datasets::digest_file(file, control);
    if (!digests) return verified;
    verified.push_back(
        {file.string(), digests->sha256 == locked.sha256 ? VerifiedState::kEqual : VerifiedState::kChanged});
  }
  return verified;
}

}  // namespace stillpoint::bench
