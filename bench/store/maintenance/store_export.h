// SPDX-License-Identifier: BSD-3-Clause
/// A store as one JSON text, and back.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/model/stored_run.h"
#include "bench/store/maintenance/maintenance.h"

namespace stillpoint::bench {

enum class ExportExtent {
  kEverything,  ///< plans, manifests, and runs with their metrics and files
  kNumbers,     ///< without files and manifests: small enough to commit to a repository
};

/// First characters of each exported text.
[[nodiscard]] std::string exported_beginning();

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
