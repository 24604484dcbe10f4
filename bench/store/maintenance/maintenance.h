// SPDX-License-Identifier: BSD-3-Clause
/// Maintenance of a store: verification, garbage collection and merge.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/store/maintenance/run_transfer.h"

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

/// Adds the completed runs of `from` to `into`, with their plans, manifests, files and acceptances. `into` is
/// created if it does not exist; runs that it already contains are not changed.
/// @throws InputError if a file of `from` is missing or damaged; runs added before remain
MergeReport merge_stores(const std::filesystem::path& from, const std::filesystem::path& into);

}  // namespace stillpoint::bench
