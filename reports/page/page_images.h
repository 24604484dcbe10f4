// SPDX-License-Identifier: BSD-3-Clause
/// Annotated images embedded in a report page.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "bench/store/store.h"
#include "reports/page/charts/run_series.h"

namespace stillpoint::report {

/// JSON of each run: frame index -> JPEG in base64. Images are added in rounds, the worst frame of every run
/// first, then the second worst of every run, until the budget is used up: every run gets its worst frames.
///
/// @param series       of each run
/// @param budget_bytes base64 size of all images together
/// @throws InputError if an image is missing or damaged
[[nodiscard]] std::vector<std::string> page_images(const bench::Store& store,
                                                   std::span<const bench::StoredRun> runs,
                                                   std::span<const RunSeries> series,
                                                   std::size_t budget_bytes);

}  // namespace stillpoint::report
