// SPDX-License-Identifier: BSD-3-Clause
/// Rows of the tables of a store as structs.
#pragma once

#include "bench/model/stored_run.h"
#include "bench/store/database.h"

namespace stillpoint::bench {

/// Columns of table `run` that `run_of` reads.
inline constexpr const char* kRunColumns =
    "id, key, system, variant, sequence, sequence_id, config_hash, build, mode, kind, cores, seed, "
    "repetition, axis, axis_value, outcome, detail, started, ended, manifest";

/// Columns of table `timing` that `cost_of` reads.
inline constexpr const char* kCostColumns = "run, module, per, calls, mean_ms, median_ms, p95_ms, max_ms";

/// A row with `kRunColumns`, without metrics, costs and files. Bytes of the detail that are not UTF-8, which
/// messages of other programs may contain, are escaped.
/// @throws InputError for an unknown outcome
[[nodiscard]] StoredRun run_of(const Statement& row);

/// A row with the columns run, name, protocol, unit, value.
[[nodiscard]] Metric metric_of(const Statement& row);

/// A row with `kCostColumns`.
[[nodiscard]] ModuleCost cost_of(const Statement& row);

}  // namespace stillpoint::bench
