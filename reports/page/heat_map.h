// SPDX-License-Identifier: BSD-3-Clause
/// What each variant is worth against a base, sequence by sequence, as a coloured HTML table.
#pragma once

#include <span>
#include <string>

#include "bench/store/stored_run.h"

namespace stillpoint {

/// The variant that ablations are held against: dynamic_vins where it was run, else stillpoint, vo, or the
/// first.
[[nodiscard]] std::string base_variant(std::span<const StoredRun> runs);

/// Relative changes of a metric with their intervals, paired by sequence and seed; warm is worse. Empty with
/// fewer than two variants.
[[nodiscard]] std::string heat_map_html(std::span<const StoredRun> runs, const std::string& base,
                                        const std::string& metric);

}  // namespace stillpoint
