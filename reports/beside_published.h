// SPDX-License-Identifier: BSD-3-Clause
/// What was measured beside what was published: one line a system, marked by where its numbers come from.
#pragma once

#include <span>
#include <string>

#include "bench/store/stored_run.h"
#include "bench/systems/published_table.h"

namespace stillpoint {

/// A Markdown table with a column for each sequence (or module) that the runs have, measured medians first,
/// then the published rows that share a column; the sources, notes and traps below. Empty if nothing can
/// stand beside.
[[nodiscard]] std::string beside_published(std::span<const StoredRun> runs, const PublishedTable& published);

}  // namespace stillpoint
