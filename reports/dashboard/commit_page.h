// SPDX-License-Identifier: BSD-3-Clause
/// Page of one commit: its change points, and its metrics compared with the previous measurement.
#pragma once

#include <string>

#include "bench/analysis/history_changes.h"

namespace stillpoint::report {

/// A self-contained page without scripts.
/// @param commit index into `history.commits`
[[nodiscard]] std::string commit_html(const bench::CommitHistory& history,
                                      const bench::HistoryChanges& changes, std::size_t commit);

}  // namespace stillpoint::report
