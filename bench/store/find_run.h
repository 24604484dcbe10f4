// SPDX-License-Identifier: BSD-3-Clause
/// A run of a store by its key.
#pragma once

#include <string>

#include "bench/store/store.h"

namespace stillpoint::bench {

/// @param key complete key of a run or a prefix of it
/// @throws InputError if no run or several runs have the prefix
[[nodiscard]] StoredRun find_run(const Store& store, const std::string& key);

}  // namespace stillpoint::bench
