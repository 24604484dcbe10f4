// SPDX-License-Identifier: BSD-3-Clause
/// Dashboard of all metrics over commits as static files; a pure function of the store.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/analysis/history_changes.h"
#include "bench/record/output_folder.h"
#include "bench/store/store.h"

namespace stillpoint::report {

struct AnalyzedHistory {
  bench::CommitHistory history;
  bench::HistoryChanges changes;
};

/// Adds subjects, author dates and links, which a store does not have.
using DescribeCommits = std::function<void(std::vector<bench::Commit>&)>;

/// Commit history of a store with its change points and drifts.
/// @param store of all systems
/// @param system as of `commit_history`
/// @throws InputError if the store has no finished runs of the system
[[nodiscard]] AnalyzedHistory analyze_history(const bench::Store& store, const std::string& system = "",
                                              const DescribeCommits& describe = {});

/// Page of one commit: its change points, and its metrics compared with the previous measurement.
/// Self-contained, without scripts.
/// @param commit index into `history.commits`
[[nodiscard]] std::string commit_html(const bench::CommitHistory& history,
                                      const bench::HistoryChanges& changes, std::size_t commit);

/// index.html, regressions.md, regressions.json, and one page per commit in commits/.
/// @throws InputError as `analyze_history`
[[nodiscard]] std::vector<bench::OutputFile> dashboard_files(const bench::Store& store,
                                                             const std::string& system = "",
                                                             const DescribeCommits& describe = {});

}  // namespace stillpoint::report
