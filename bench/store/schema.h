// SPDX-License-Identifier: BSD-3-Clause
/// The tables of a store, the migration of older stores, and rows of the tables as structs.
#pragma once

#include <cstdint>
#include <string>

#include "bench/model/stored_run.h"
#include "bench/store/database.h"

namespace stillpoint::bench {

/// Application id in the header of each store, "Stlp"; identifies it also to the program `file`.
inline constexpr std::int64_t kApplicationId = 0x53746c70;

/// Newest schema version that this program supports.
[[nodiscard]] int schema_version();

/// Creates the tables in an empty file, or migrates an older store; stored rows are kept.
/// @param version to migrate to; only tests need an older one
/// @throws InputError if the file belongs to another program, or was written by a newer version
void migrate(const Database& database, int version = schema_version());

/// Checks that a store can be read. Older stores are read without migration; tables that they lack are empty.
/// @throws InputError as `migrate`, and if the file is empty
void require_readable_schema(const Database& database);

/// Column and JSON key of a metric's protocol before schema 3 and before version 2 of exports.
inline constexpr const char* kOldProtocolName = "recipe";  // alias, read only

/// Column of table `metric` with the evaluation protocol. Call it in the transaction that reads the table.
[[nodiscard]] std::string protocol_column(const Database& database);

/// Current name of a kind of attachment; images had another prefix than `kImageKind` before schema 3.
[[nodiscard]] std::string current_kind(const std::string& kind);

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
