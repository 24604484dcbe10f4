// SPDX-License-Identifier: BSD-3-Clause
#include "bench/fetch/locked_download.h"

#include <cstdlib>

#include <fmt/format.h>

#include "bench/fetch/data_lock.h"
#include "bench/model/utc_time.h"
#include "datasets/download/download.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using datasets::CatalogueArchive;
using datasets::CatalogueDataset;

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

fs::path download_path(const fs::path& root, const CatalogueDataset& dataset, const std::string& file) {
  return root / dataset.name / "downloads" / fs::path(file).filename();
}

bool download_locked(const CatalogueDataset& dataset, const CatalogueArchive& archive,
                     const FetchOptions& options, const FetchControl& control) {
  const std::string key = dataset.name + "/" + archive.file;
  datasets::DownloadRequest request = request_of(dataset, archive, options);
  fs::create_directories(request.file.parent_path());
  const DataLock lock = read_data_lock(options.root);
  const auto locked = lock.files.find(key);
  if (request.sha256.empty() && locked != lock.files.end()) request.sha256 = locked->second.sha256;
  const std::string name = request.file.filename().string();
  const auto downloaded = datasets::download(request, control.step("downloading " + name));
  if (!downloaded) return false;
  if (locked != lock.files.end()) return true;
  const bool is_published = !archive.sha256.empty() || !archive.md5.empty();
  lock_file(options.root, key,
            {.bytes = downloaded->digests.bytes,
             .sha256 = downloaded->digests.sha256,
             .url = downloaded->url,
             .date = utc_now(),
             .published = is_published});
  if (!is_published) {
    control.report(fmt::format("{}: no digest is published; SHA-256 {} is recorded and required from now on",
                               name, downloaded->digests.sha256));
  }
  return true;
}

}  // namespace stillpoint::bench
