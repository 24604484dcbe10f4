// SPDX-License-Identifier: BSD-3-Clause
/// Transfer of completed runs into a store.
#pragma once

#include <cstddef>

#include "bench/model/stored_run.h"
#include "bench/store/store_writer.h"

namespace stillpoint::bench {

struct MergeReport {
  std::size_t added = 0;
  std::size_t present = 0;  ///< already in the target store
};

/// Adds a completed run unless the store already contains it. @return whether it was added
bool add_run(StoreWriter& writer, const RunIdentity& identity, const RunOutcome& outcome);

}  // namespace stillpoint::bench
