// SPDX-License-Identifier: BSD-3-Clause
/// The pictures that a page carries.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "bench/store/store.h"
#include "reports/page/run_series.h"

namespace stillpoint {

/// JSON of each run: position of a frame -> JPEG in base64. The worst frame of each run comes first, then the
/// second of each, until the page has no room: what is mailed must stay small, and no run goes without.
///
/// @param series of each run
/// @param room for all pictures together [bytes of base64]
/// @throws InputError if a picture is missing or damaged
[[nodiscard]] std::vector<std::string> page_pictures(const Store& store, std::span<const StoredRun> runs,
                                                     std::span<const RunSeries> series, std::size_t room);

}  // namespace stillpoint
