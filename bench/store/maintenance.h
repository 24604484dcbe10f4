// SPDX-License-Identifier: BSD-3-Clause
/// Looking after a store: checking it, clearing it, and moving runs between stores.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/store/stored_run.h"

namespace stillpoint {

/// Everything that is wrong with a store, a line each; empty if nothing is. Reads every file.
/// @throws InputError if it cannot be opened at all
[[nodiscard]] std::vector<std::string> verify_store(const std::filesystem::path& file);

struct GarbageReport {
  std::size_t files = 0;  ///< that no run names
  std::int64_t bytes = 0;
  std::size_t manifests = 0;
};

/// Removes files and manifests that no run names any more, and what dead drivers left behind.
GarbageReport collect_garbage(const std::filesystem::path& file);

struct MergeReport {
  std::size_t added = 0;
  std::size_t present = 0;  ///< were there already
};

/// Adds the ended runs of `from` to `into`, which is made if need be, with their plans, manifests, files and
/// acceptances.
/// A run that is there already stays as it is.
/// @throws InputError if a file of `from` is missing or damaged; what was added before is kept
MergeReport merge_stores(const std::filesystem::path& from, const std::filesystem::path& into);

enum class ExportExtent {
  kEverything,  ///< plans, manifests, and runs with their numbers and files
  kNumbers,     ///< without files and manifests: small enough to be kept with the sources
};

/// A store as one JSON text.
[[nodiscard]] std::string export_store(const std::filesystem::path& file,
                                       ExportExtent extent = ExportExtent::kEverything);

/// Adds the runs of an exported text, as `merge_stores` does.
/// @param place name of the text in messages
MergeReport import_store(const std::string& text, const std::string& place,
                         const std::filesystem::path& into);

/// Ended runs of an exported text, without their files.
/// @param place name of the text in messages
/// @throws InputError if it is no exported text
[[nodiscard]] std::vector<StoredRun> exported_runs(const std::string& text, const std::string& place);

}  // namespace stillpoint
