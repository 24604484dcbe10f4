// SPDX-License-Identifier: BSD-3-Clause
/// The tables of a store, and how an older store is brought up to date.
#pragma once

#include "bench/store/database.h"

namespace stillpoint {

/// Version of the newest schema that this program knows.
[[nodiscard]] int schema_version();

/// Makes the tables in an empty file, or adds what an older store lacks; stored rows are kept.
/// @throws InputError if the file is another program's database, or a newer program's store
void migrate(const Database& database);

/// Older stores are read as they are: what they lack is empty.
/// @throws InputError as `migrate`, and if the file is empty: reading changes nothing
void require_readable_schema(const Database& database);

}  // namespace stillpoint
