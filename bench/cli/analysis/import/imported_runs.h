// SPDX-License-Identifier: BSD-3-Clause
/// Results of other tools as runs of a store.
#pragma once

#include <filesystem>
#include <vector>

#include "bench/model/stored_run.h"
#include "bench/store/maintenance/maintenance.h"

namespace stillpoint::bench {

struct ImportedRun {
  RunIdentity identity;
  RunOutcome outcome;
};

/// What the identities of imported runs have in common.
[[nodiscard]] RunIdentity imported_identity();

/// Adds the runs that the store does not have; all of them or, after an error, none.
/// @param store is created if it does not exist
/// @throws InputError if the store has another outcome, value or protocol of a metric for the same system,
/// variant, sequence and repetition
[[nodiscard]] MergeReport add_imported(const std::filesystem::path& store,
                                       const std::vector<ImportedRun>& runs);

}  // namespace stillpoint::bench
