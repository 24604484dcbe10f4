// SPDX-License-Identifier: BSD-3-Clause
/// Maintenance of a store: verification, garbage collection, merge, export and import.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/model/stored_run.h"

namespace stillpoint::bench {

/// Faults of a store, one line each; empty if there are none. Reads every file.
/// @throws InputError if it cannot be opened at all
[[nodiscard]] std::vector<std::string> verify_store(const std::filesystem::path& file);

struct GarbageReport {
  std::size_t files = 0;  ///< without a reference from a run
  std::int64_t bytes = 0;
  std::size_t manifests = 0;
};

/// Removes files and manifests that no run references, and the folders of dead workers.
GarbageReport collect_garbage(const std::filesystem::path& file);

struct MergeReport {
  std::size_t added = 0;
  std::size_t present = 0;  ///< already in the target store
};

/// Adds the completed runs of `from` to `into`, with their plans, manifests, files and acceptances. `into` is
/// created if it does not exist; runs that it already contains are not changed.
/// @throws InputError if a file of `from` is missing or damaged; runs added before remain
MergeReport merge_stores(const std::filesystem::path& from, const std::filesystem::path& into);

enum class ExportExtent {
  kEverything,  ///< plans, manifests, and runs with their metrics and files
  kNumbers,     ///< without files and manifests: small enough to commit to a repository
};

/// A store as one JSON text (version 2 of the format; version 1 used the names of schema 2).
[[nodiscard]] std::string export_store(const std::filesystem::path& file,
                                       ExportExtent extent = ExportExtent::kEverything);

/// Adds the runs of an exported text of any version, as `merge_stores` does.
/// @param place name of the text in messages
MergeReport import_store(const std::string& text, const std::string& place,
                         const std::filesystem::path& into);

/// Completed runs of an exported text, without their files.
/// @param place name of the text in messages
/// @throws InputError if it is not an exported store
[[nodiscard]] std::vector<StoredRun> exported_runs(const std::string& text, const std::string& place);

}  // namespace stillpoint::bench
