// SPDX-License-Identifier: BSD-3-Clause
/// Every number over commits as static files: a pure function of the store.
#pragma once

#include <vector>

#include "bench/compare/history_changes.h"
#include "bench/record/output_folder.h"
#include "bench/store/store.h"

namespace stillpoint {

struct JudgedHistory {
  CommitHistory history;
  HistoryChanges changes;
};

/// What a store says of its commits.
/// @throws InputError if no run of our odometry has ended: that nothing became worse would be no news
[[nodiscard]] JudgedHistory judged_history(const Store& store);

/// index.html, regressions.md, regressions.json, and a page for each commit in commits/.
/// @throws InputError as `judged_history`
[[nodiscard]] std::vector<OutputFile> dashboard_files(const Store& store);

}  // namespace stillpoint
