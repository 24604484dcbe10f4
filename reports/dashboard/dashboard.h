// SPDX-License-Identifier: BSD-3-Clause
/// Every number over commits as static files: a pure function of the store.
#pragma once

#include <vector>

#include "bench/compare/history_changes.h"
#include "bench/record/output_folder.h"
#include "bench/store/store.h"

namespace stillpoint {

/// index.html, regressions.md, regressions.json, and a page for each commit in commits/.
/// @throws InputError if no run of our odometry has ended
[[nodiscard]] std::vector<OutputFile> dashboard_files(const Store& store);

}  // namespace stillpoint
