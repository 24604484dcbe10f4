// SPDX-License-Identifier: BSD-3-Clause
#include "bench/fetch/data_lock.h"

#include <nlohmann/json.hpp>

#include "bench/model/json_problem.h"
#include "bench/model/utc_time.h"
#include "bench/process/file_lock.h"
#include "bench/record/output_folder.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

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

void lock_file(const fs::path& root, const std::string& key, const LockedFile& file) {
  change_lock(root, [&](DataLock& lock) { lock.files.insert({key, file}); });
}

}  // namespace stillpoint::bench
