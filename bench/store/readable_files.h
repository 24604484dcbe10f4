// SPDX-License-Identifier: BSD-3-Clause
/// Runs of a store of which some attached files are missing or damaged.
#pragma once

#include <string>
#include <vector>

#include "bench/store/store.h"

namespace stillpoint::bench {

struct ReadableRuns {
  std::vector<StoredRun> runs;    ///< without the unreadable files
  std::vector<std::string> gaps;  ///< one line per run with unreadable files
};

/// Reads all files of the runs, and removes the entries of those that are missing or damaged, so that readers
/// find them absent. The details of these runs name them.
[[nodiscard]] ReadableRuns without_unreadable_files(const Store& store, std::vector<StoredRun> runs);

}  // namespace stillpoint::bench
